// SPDX-License-Identifier: Apache-2.0
// Kinds of coordinates that the grid rules tell apart, each a generator of doubles.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>
#include <string>

#include "grid_oracle.hpp"

namespace families {

using Engine = std::mt19937_64;
using Family = double (*)(Engine&);

inline double uniform(Engine& e, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(e);
}
inline std::int64_t integer(Engine& e, std::int64_t low, std::int64_t high) {
  return std::uniform_int_distribution<std::int64_t>(low, high)(e);
}
inline double decimal(std::int64_t n, int d) {
  return std::strtod((std::to_string(n) + "e-" + std::to_string(d)).c_str(), nullptr);
}
inline double of_bits(std::uint64_t bits) {
  double v;
  std::memcpy(&v, &bits, sizeof v);
  return v;
}

inline const std::map<std::string, Family> all = {
    {"uniform in the unit square", [](Engine& e) { return uniform(e, 0, 1); }},
    {"uniform around 0", [](Engine& e) { return uniform(e, -1, 1); }},
    {"UTM metres to the millimetre", [](Engine& e) { return decimal(integer(e, 400000000, 5700000000), 3); }},
    {"UTM metres, unrounded", [](Engine& e) { return uniform(e, 5600000, 5700000); }},
    {"degrees with 6 decimals", [](Engine& e) { return decimal(integer(e, -180000000, 180000000), 6); }},
    {"degrees with 7 decimals", [](Engine& e) { return decimal(integer(e, -1800000000, 1800000000), 7); }},
    {"tenths", [](Engine& e) { return decimal(integer(e, -20, 20), 1); }},
    {"small integers", [](Engine& e) { return double(integer(e, -5, 5)); }},
    {"32-bit integers", [](Engine& e) { return double(integer(e, -2147483648ll, 2147483647ll)); }},
    {"31-bit integers", [](Engine& e) { return double(integer(e, 0, 2147483647ll)); }},
    {"integers up to 2^53", [](Engine& e) { return double(integer(e, 0, 1ll << 53)); }},
    {"integers above 2^53 in a short range", [](Engine& e) { return double((1ll << 60) + 256 * integer(e, 0, 1000)); }},
    {"eighths", [](Engine& e) { return double(integer(e, -1000, 1000)) / 8; }},
    {"gaps of 1e-17", [](Engine& e) { return 1e-17 * double(integer(e, 0, 100)); }},
    {"one and neighbours", [](Engine& e) { return 1 + double(integer(e, -8, 8)) * std::ldexp(1.0, -53); }},
    {"powers of two", [](Engine& e) { return std::ldexp(1.0, int(integer(e, -40, 40))); }},
    {"powers of two and ten",
     [](Engine& e) {
       return integer(e, 0, 1) ? std::ldexp(1.0, int(integer(e, -4, 4))) : decimal(1, int(integer(e, 0, 5)));
     }},
    {"far powers of two",
     [](Engine& e) { return std::ldexp(integer(e, 0, 1) ? -1.0 : 1.0, int(integer(e, -1074, 1023))); }},
    {"denormals", [](Engine& e) { return of_bits(std::uint64_t(integer(e, 0, (1ll << 52) - 1))); }},
    {"few denormals", [](Engine& e) { return of_bits(std::uint64_t(integer(e, 0, 9))); }},
    {"1e300 and less", [](Engine& e) { return uniform(e, -1e300, 1e300); }},
    {"the largest doubles",
     [](Engine& e) {
       return (integer(e, 0, 1) ? -1 : 1) * of_bits(0x7FEFFFFFFFFFFFFFull - std::uint64_t(integer(e, 0, 3)));
     }},
    {"1e300, 1 and 1e-300", [](Engine& e) { return std::ldexp(uniform(e, -1, 1), 1000 * int(integer(e, -1, 1))); }},
    {"any bits",
     [](Engine& e) {
       double v;
       do v = of_bits(e());
       while (!std::isfinite(v));
       return v;
     }},
    {"a decimal range far from 0", [](Engine& e) { return decimal(123456789012ll + integer(e, 0, 100000), 2); }},
    {"the last digits of a double", [](Engine& e) { return decimal(1234567890123450ll + integer(e, 0, 50), 6); }},
    {"17 digits", [](Engine& e) { return decimal(80000000000000000ll + integer(e, 0, 2000), 17); }},
    {"22 decimals", [](Engine& e) { return decimal(integer(e, 0, 1000), 22); }},
    {"23 decimals", [](Engine& e) { return decimal(integer(e, 0, 1000), 23); }},
    {"decimals near 2^63",
     [](Engine& e) { return decimal(9223372036854770000ll + 100 * integer(e, 0, 50), int(integer(e, 3, 4))); }},
    {"above 2^63", [](Engine& e) { return 1e19 + 2048 * double(integer(e, 0, 1ll << 40)); }},
    {"quarters where decimals are ambiguous",
     [](Engine& e) { return 1125899906842624.0 + double(integer(e, 0, 400)) / 4; }},
    {"neighbours of a binade boundary",
     [](Engine& e) { return of_bits(0x4330000000000000ull + std::uint64_t(integer(e, -20, 20))) / 1024; }},
    {"both zeros and one", [](Engine& e) { return integer(e, 0, 2) == 0 ? 1.0
                                                  : integer(e, 0, 1)    ? 0.0
                                                                        : -0.0; }},
    {"halves of a coarse cell",
     [](Engine& e) { return integer(e, 0, 9) == 0 ? 4294967294.0 : double(integer(e, 0, 4294967294ll)) / 2; }},
    {"float", [](Engine& e) { return double(float(uniform(e, -1000, 1000))); }},
};

inline oracle::Doubles draw(Engine& e, std::size_t n, Family x, Family y) {
  oracle::Doubles points(n);
  for (auto& p : points) p = {x(e), y(e)};
  return points;
}

}  // namespace families
