// SPDX-License-Identifier: Apache-2.0
#include "phases/refine_rules.hpp"

namespace gcdt {

namespace {

constexpr unsigned unit_bits = 56;

std::int64_t times(std::int64_t a, std::int64_t b) {
  const device::Int128 product = device::gcdt_multiply(a, b);
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(product.high) << (64 - unit_bits) |
                                   product.low >> unit_bits);
}

// first - first x^2 / ((k+1)(k+2)) + ...: Taylor's series from the term of degree k on. Ends: terms fall to 0, each to
// less than half of the one before from degree 2 on (x < 1.6).
std::int64_t series(std::int64_t first, std::int64_t squared, std::int64_t k) {
  std::int64_t sum = 0;
  for (std::int64_t term = first; term != 0; k += 2) {
    sum += term;
    term = -times(term < 0 ? -term : term, squared) / ((k + 1) * (k + 2)) * (term < 0 ? -1 : 1);
  }
  return sum;
}

}  // namespace

SineCosine sine_cosine(std::uint32_t millionths) {
  constexpr std::int64_t pi = 226375608064910089, half_turn = 180000000;  // pi in units of 2^-56
  const std::int64_t x = pi / half_turn * millionths + pi % half_turn * millionths / half_turn;
  const std::int64_t squared = times(x, x);
  return {series(x, squared, 1), series(std::int64_t{1} << unit_bits, squared, 0)};
}

std::uint64_t rounded_ratio(std::int64_t numerator, std::int64_t denominator, unsigned bits) {
  std::uint64_t ratio = static_cast<std::uint64_t>(numerator / denominator);
  std::int64_t rest = numerator % denominator;
  for (unsigned bit = 0; bit < bits; ++bit) {
    rest *= 2;
    ratio = 2 * ratio + (rest >= denominator);
    if (rest >= denominator) rest -= denominator;
  }
  return ratio + (2 * rest >= denominator);
}

device::RefineRules refine_rules(std::uint32_t millionths, std::uint32_t least_length) {
  const SineCosine whole = sine_cosine(millionths), twice = sine_cosine(2 * millionths),
                   half = sine_cosine(millionths / 2);
  device::RefineRules rules = {};
  rules.tangent = rounded_ratio(whole.sine, whole.cosine, 31);
  rules.lens = rounded_ratio(twice.sine, twice.cosine, 31);
  rules.off_centre = rounded_ratio(19 * half.cosine, 40 * half.sine, 24);  // 0.475
  rules.most_area = ~std::uint64_t{0};
  rules.least_squared = std::uint64_t{least_length} * least_length;
  return rules;
}

}  // namespace gcdt
