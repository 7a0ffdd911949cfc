// SPDX-License-Identifier: Apache-2.0
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdlib>

/// Mesa's rusticl, a second vendor on any CPU, hides its software renderer unless it is asked for before anything lists
/// devices: whoever lists them first, a test or what it calls.
int main(int argc, char** argv) {
#ifndef _WIN32
  setenv("RUSTICL_ENABLE", "swrast", 0);
#endif
  return doctest::Context(argc, argv).run();
}
