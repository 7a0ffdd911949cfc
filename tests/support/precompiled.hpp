// SPDX-License-Identifier: Apache-2.0
// What most tests include, compiled once for all of them (tests/CMakeLists.txt).
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gcdt/gcdt.hpp>
#include <gcdt/gcdt_pool.hpp>

#include "device/runtime.hpp"
#include "device_list.hpp"
#include "reference.hpp"
