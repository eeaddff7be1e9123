/// @file
/// Mathematical functions of the core, with the same bits on every processor. No C library is
/// linked on the target, and two libraries never agree on expf.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/base/complex.hpp"

#if defined(__cplusplus) && __cplusplus < 202002L
#error "zerorate is written in C++20: compile its files with -std=c++20 or later"
#endif
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "-ffast-math changes what zerorate computes: compile its files with -fno-fast-math"
#endif
#if defined(__FLT_EVAL_METHOD__) && (__FLT_EVAL_METHOD__ == 1 || __FLT_EVAL_METHOD__ == 2)
#error \
    "float is computed with more digits than a float has: on x86 compile with -msse2 -mfpmath=sse"
#endif

namespace zerorate::core {

/// False for NaN and both infinities; a test of the bits, so that no compiler flag removes it.
[[nodiscard]] constexpr bool is_finite(float x) {
  return (std::bit_cast<std::uint32_t>(x) & 0x7F800000U) != 0x7F800000U;
}

/// False for zero, negative numbers, NaN and infinity. One comparison: the bits of positive numbers
/// are in the order of the numbers, between those of 0 and of infinity.
[[nodiscard]] constexpr bool is_finite_positive(float x) {
  return std::bit_cast<std::uint32_t>(x) - 1U < 0x7F7FFFFFU;
}

/// The nearest float to a 64-bit integer, ties to even, as every processor with a conversion
/// instruction rounds it. The compiler's own routine for the Cortex-M0+ goes through double.
[[nodiscard]] constexpr float to_float(std::int64_t x) {
  const auto bits = static_cast<std::uint64_t>(x);
  const std::uint64_t magnitude = x < 0 ? 0U - bits : bits;
  const int excess_bits = 32 - std::countl_zero(magnitude);
  const auto shift = static_cast<std::uint32_t>(excess_bits > 0 ? excess_bits : 0);
  const auto top = static_cast<std::uint32_t>(magnitude >> shift);
  // One sticky bit below the rounding position stands for the digits that are cut off.
  const std::uint32_t sticky = (std::uint64_t{top} << shift) != magnitude ? 1U : 0U;
  const auto power_of_two = std::bit_cast<float>((127U + shift) << 23U);
  const float rounded = static_cast<float>(top | sticky) * power_of_two;
  return x < 0 ? -rounded : rounded;
}

namespace detail {
/// Correctly rounded square root of a positive normal or subnormal number in integer arithmetic.
/// Cost: 25 shift-and-subtract steps, about 200 instructions on a Cortex-M0+.
[[nodiscard]] constexpr float square_root_by_digits(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  std::int32_t exponent = static_cast<std::int32_t>(bits >> 23U) - 127;
  std::uint32_t mantissa = bits & 0x7FFFFFU;
  if (exponent == -127) {  // subnormal: shift up to a leading one
    const int shift = std::countl_zero(mantissa) - 8;
    mantissa <<= static_cast<unsigned>(shift);
    exponent = -126 - shift;
  } else {
    mantissa |= 0x800000U;
  }
  if ((exponent & 1) != 0) {
    mantissa <<= 1U;
    --exponent;
  }
  std::uint32_t rest = 0;
  std::uint32_t root = 0;
  std::uint64_t radicand = static_cast<std::uint64_t>(mantissa) << 25U;  // 50 bits, 25 digits
  for (int digit = 0; digit < 25; ++digit) {
    rest = (rest << 2U) | static_cast<std::uint32_t>((radicand >> 48U) & 3U);
    radicand <<= 2U;
    const std::uint32_t trial = (root << 2U) | 1U;
    root <<= 1U;
    if (rest >= trial) {
      rest -= trial;
      root |= 1U;
    }
  }
  // 24 digits and one to round by; a square root is never exactly half-way between two floats.
  const std::uint32_t rounded = (root >> 1U) + (root & 1U);
  const std::uint32_t result = rounded + (static_cast<std::uint32_t>(exponent / 2 + 126) << 23U);
  return std::bit_cast<float>(result);
}
}  // namespace detail

#if defined(__SSE2__) || defined(__ARM_FP) || defined(__riscv_flen)
#define ZERORATE_HAS_SQUARE_ROOT_INSTRUCTION
namespace detail {
/// One instruction, correctly rounded by IEEE 754. Not __builtin_sqrtf(), which is a call of a
/// maths library too wherever errno counts.
[[nodiscard]] inline float square_root_by_instruction(float x) {
  float root;  // NOLINT(cppcoreguidelines-init-variables): the instruction writes it
#if defined(__SSE2__)
  asm("sqrtss %1, %0" : "=x"(root) : "x"(x));
#elif defined(__aarch64__)
  asm("fsqrt %s0, %s1" : "=w"(root) : "w"(x));
#elif defined(__ARM_FP)
  asm("vsqrt.f32 %0, %1" : "=t"(root) : "t"(x));
#else
  asm("fsqrt.s %0, %1" : "=f"(root) : "f"(x));
#endif
  return root;
}
}  // namespace detail
#endif

/// Correctly rounded square root; 0 for 0, for negative numbers and for NaN. A variance is one of
/// the last two only after a fault, which its owner reports.
[[nodiscard]] constexpr float square_root(float x) {
  if (!(x > 0.0F)) {
    return 0.0F;
  }
#ifdef ZERORATE_HAS_SQUARE_ROOT_INSTRUCTION
  if (!std::is_constant_evaluated()) {
    return detail::square_root_by_instruction(x);
  }
#endif
  if (!is_finite(x)) {
    return x;
  }
  return detail::square_root_by_digits(x);
}

/// 1 - exp(-x) without cancellation: the share of a first-order lag that is gone after x time
/// constants. x real and not negative, or complex with such a real part: 1 - exp(-x) then belongs
/// to a damped rotation. Taylor's series on x / 2^k, then k doublings a(2x) = a(x) (2 - a(x)), in
/// which nothing cancels. Relative error below 4e-7 for real x.
template <class Scalar>
[[nodiscard]] constexpr Scalar one_minus_exp_neg(Scalar x) {
  if (real_part(x) >= 32.0F) {
    return Scalar{1.0F};
  }
  int doublings = 0;
  while (squared_magnitude(x) > 0.0625F * 0.0625F) {
    x = 0.5F * x;
    ++doublings;
  }
  const Scalar one{1.0F};
  Scalar share = x * (one - 0.5F * x * (one - (1.0F / 3.0F) * x * (one - 0.25F * x)));
  for (; doublings > 0; --doublings) {
    share = share * (Scalar{2.0F} - share);
  }
  return share;
}

/// Factor on a variance that was estimated with f degrees of freedom. With it a limit of sqrt(z2)
/// standard deviations is exceeded as rarely as with a known variance: the square of Student's t,
/// f (exp(z2 / f) - 1) (Wallace 1959), over that of the normal number. exp(x) is computed as
/// (1 + x / 256)^256: 0.05 % low at x = 0.5, 7 % at x = 6.
[[nodiscard]] constexpr float student_factor(float z2, float degrees_of_freedom) {
  const float exponent = z2 / degrees_of_freedom;
  float growth = (1.0F / 256.0F) * exponent;  // power minus 1, without cancellation
  for (int doubling = 0; doubling < 8; ++doubling) growth *= 2.0F + growth;
  return growth / exponent;
}

/// Natural logarithm of a positive normal number, relative error below 3e-7 away from 1 and
/// absolute error below 1e-7 near it: the exponent from the bits, the rest by the series of atanh.
[[nodiscard]] constexpr float natural_log(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  int exponent = static_cast<int>(bits >> 23U) - 127;
  auto mantissa = std::bit_cast<float>((bits & 0x7FFFFFU) | 0x3F800000U);
  if (mantissa > 1.41421356F) {
    mantissa *= 0.5F;
    ++exponent;
  }
  const float s = (mantissa - 1.0F) / (mantissa + 1.0F);
  const float s2 = s * s;
  const float series =
      1.0F + s2 * (1.0F / 3.0F + s2 * (1.0F / 5.0F + s2 * (1.0F / 7.0F + s2 * (1.0F / 9.0F))));
  return static_cast<float>(exponent) * 0.693147181F + 2.0F * s * series;
}

/// Halves round up. |x| below 2^31.
[[nodiscard]] constexpr float nearest_integer(float x) {
  const float shifted = x + 0.5F;
  const auto truncated = static_cast<float>(static_cast<std::int32_t>(shifted));
  return truncated > shifted ? truncated - 1.0F : truncated;
}

/// True if no number differs from its partner by more than the root of the limit.
template <std::size_t N>
[[nodiscard]] constexpr bool are_near(const std::array<float, N>& a, const std::array<float, N>& b,
                                      float squared_limit) {
  for (std::size_t i = 0; i < N; ++i) {
    const float change = a[i] - b[i];
    if (change * change > squared_limit) return false;
  }
  return true;
}

/// Largest magnitude of a number in a saved state (SI units). Products of two of them and the
/// square of a time in ticks stay within single precision.
inline constexpr float kLargestRemembered = 1e12F;

/// False for NaN, infinity and magnitudes beyond kLargestRemembered.
[[nodiscard]] constexpr bool is_plausible(float x) {
  return x >= -kLargestRemembered && x <= kLargestRemembered;
}
[[nodiscard]] constexpr bool is_plausible_variance(float x) {
  return x >= 0.0F && x <= kLargestRemembered;
}
[[nodiscard]] constexpr bool is_plausible_rate(float rate_rad_s) {
  constexpr float kLargest_rad_s = 1e6F;
  return rate_rad_s >= -kLargest_rad_s && rate_rad_s <= kLargest_rad_s;
}
template <std::size_t N>
[[nodiscard]] constexpr bool are_plausible(const std::array<float, N>& numbers) {
  for (const float x : numbers) {
    if (!is_plausible(x)) return false;
  }
  return true;
}
template <std::size_t N>
[[nodiscard]] constexpr bool are_plausible_variances(const std::array<float, N>& numbers) {
  for (const float x : numbers) {
    if (!is_plausible_variance(x)) return false;
  }
  return true;
}

/// Whether the byte of a bool is 0 or 1. To read any other byte as a bool is undefined.
[[nodiscard]] inline bool is_bool(const bool& flag) {
  return reinterpret_cast<const unsigned char&>(flag) <= 1U;
}
/// Whether that holds for every one of them.
template <class... Flags>
[[nodiscard]] bool are_bools(const Flags&... flags) {
  return (is_bool(flags) && ...);
}

}  // namespace zerorate::core
