// SPDX-License-Identifier: Apache-2.0
// The device that tests run on, and the statement every result must fulfil.
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include <gcdt/gcdt.hpp>
#include <gcdt/verify.hpp>

#include "workloads.hpp"

namespace gcdt::test {

/// PoCL's CPU by number, or what the variable GCDT_TEST_DEVICE says. Throws if there is none: a missing
/// device fails the tests.
std::string test_device();

/// One for all tests of a file.
Solver& solver();

MeshView view(const Triangulation& mesh);

/// Empty if the independent checker accepts the mesh, all of it, and it stayed within the memory promised.
std::string fault(Points points, Constraints constraints, const Triangulation& mesh,
                  Crossing crossing = Crossing::reject);

}  // namespace gcdt::test
