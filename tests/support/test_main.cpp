// SPDX-License-Identifier: Apache-2.0
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "mesa.hpp"

/// Of any test, whether it or what it calls lists devices first.
int main(int argc, char** argv) {
  gcdt::test::ask_for_mesa();
  return doctest::Context(argc, argv).run();
}
