/// @file
/// Sums and products in single precision as IEEE 754 has them, rounded to nearest, on bit patterns.
///
/// Every case is covered: subnormal numbers, zeros of both signs, infinities, not-a-numbers (one
/// pattern for all). The Cortex-M0+ uses this code for rare cases; soft_float.S has the same
/// algorithm in instructions for the common ones.
#pragma once

#include <bit>
#include <cstdint>
#include <utility>

namespace zerorate::soft_float {

using Bits = std::uint32_t;

inline constexpr Bits kSign = 0x8000'0000;
inline constexpr Bits kInfinity = 0x7F80'0000;
inline constexpr Bits kNotANumber = 0x7FC0'0000;

namespace detail {

/// significand / 2^31 times 2^(exponent - 127), the highest bit of the significand being 1. Bits
/// that were shifted out are summed up in the lowest one: they decide between near and exact.
struct Number {
  int exponent = 0;
  Bits significand = 0;
};

[[nodiscard]] constexpr Number normalised(Number x) {
  const int zeros = std::countl_zero(x.significand);
  return {x.exponent - zeros, x.significand << zeros};
}
/// Operates on a positive finite number.
[[nodiscard]] constexpr Number unpacked(Bits x) {
  const Bits exponent = x >> 23U;
  if (exponent == 0) return normalised({1, x << 8U});
  return {static_cast<int>(exponent), (x << 8U) | kSign};
}
[[nodiscard]] constexpr Bits shifted_right(Bits significand, int places) {
  if (places == 0) return significand;
  if (places > 31) return 1;
  return (significand >> places) | ((significand << (32 - places)) != 0 ? 1U : 0U);
}
/// Rounds to 24 bits, ties to even.
[[nodiscard]] constexpr Bits rounded(Bits significand) {
  const Bits near = (significand >> 8U) + ((significand >> 7U) & 1U);
  return (significand & 0xFFU) == 0x80U ? near & ~Bits{1} : near;
}
/// The one before the point, where there is one, counts one into the exponent.
[[nodiscard]] constexpr Bits packed(Bits sign, Number x) {
  if (x.exponent >= 255) return sign | kInfinity;
  if (x.exponent <= 0) return sign + rounded(shifted_right(x.significand, 1 - x.exponent));
  return sign + (static_cast<Bits>(x.exponent - 1) << 23U) + rounded(x.significand);
}

/// The upper 32 bits of the product of two numbers of 24 bits at the top of 32, by products that
/// fit into 32 bits: of 16 and 8 bits.
[[nodiscard]] constexpr Bits product(Bits a, Bits b) {
  const Bits a_low = (a >> 8U) & 0xFFU;
  const Bits b_low = (b >> 8U) & 0xFFU;
  const Bits low = a_low * b_low;
  const Bits middle = (a >> 16U) * b_low + a_low * (b >> 16U) + (low >> 8U);
  const Bits high = (a >> 16U) * (b >> 16U) + (middle >> 8U);
  return high | (((low | middle) & 0xFFU) != 0 ? 1U : 0U);
}

}  // namespace detail

[[nodiscard]] constexpr Bits multiply(Bits a, Bits b) {
  const Bits sign = (a ^ b) & kSign;
  a &= ~kSign;
  b &= ~kSign;
  if (a > kInfinity || b > kInfinity) return kNotANumber;
  if (a == kInfinity || b == kInfinity) {
    return a == 0 || b == 0 ? kNotANumber : sign | kInfinity;
  }
  if (a == 0 || b == 0) return sign;
  const detail::Number x = detail::unpacked(a);
  const detail::Number y = detail::unpacked(b);
  return detail::packed(sign, detail::normalised({x.exponent + y.exponent - 126,
                                                  detail::product(x.significand, y.significand)}));
}

[[nodiscard]] constexpr Bits add(Bits a, Bits b) {
  if ((a & ~kSign) < (b & ~kSign)) std::swap(a, b);
  const Bits sign = a & kSign;
  const bool is_sum = ((a ^ b) & kSign) == 0;
  if ((a & ~kSign) > kInfinity) return kNotANumber;
  if ((a & ~kSign) == kInfinity) return is_sum || (b & ~kSign) != kInfinity ? a : kNotANumber;
  if ((b & ~kSign) == 0) return (a & ~kSign) == 0 ? a & b : a;
  const detail::Number x = detail::unpacked(a & ~kSign);
  const detail::Number y = detail::unpacked(b & ~kSign);
  const Bits aligned = detail::shifted_right(y.significand, x.exponent - y.exponent);
  if (!is_sum) {
    const Bits difference = x.significand - aligned;
    return difference == 0 ? 0 : detail::packed(sign, detail::normalised({x.exponent, difference}));
  }
  const Bits sum = x.significand + aligned;
  if (sum >= x.significand) return detail::packed(sign, {x.exponent, sum});
  return detail::packed(sign, {x.exponent + 1, detail::shifted_right(sum, 1) | kSign});
}

}  // namespace zerorate::soft_float
