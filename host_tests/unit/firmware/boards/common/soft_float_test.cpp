#include "firmware/boards/common/soft_float.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

// The oracle is this machine's floating-point unit. The routines of the Cortex-M0+, which come here
// for what is rare only, are compared on ten million operations by host_tests/emulated/mps2.

namespace zerorate::soft_float {
namespace {

Bits one_pattern(float x) {
  return std::isnan(x) ? kNotANumber : std::bit_cast<Bits>(x);
}
void expect_that_of_the_processor(Bits a, Bits b) {
  const auto x = std::bit_cast<float>(a);
  const auto y = std::bit_cast<float>(b);
  ASSERT_EQ(multiply(a, b), one_pattern(x * y)) << std::hex << a << " * " << b;
  ASSERT_EQ(add(a, b), one_pattern(x + y)) << std::hex << a << " + " << b;
}

TEST(SoftFloat, IsThatOfTheProcessorForAllPairsOfExponents) {
  constexpr std::array<Bits, 7> kFractions{0,         1,         0x3F'FFFF, 0x40'0000,
                                           0x40'0001, 0x7F'FFFE, 0x7F'FFFF};
  std::mt19937 random(1);
  for (Bits i = 0; i < 256; ++i) {
    for (Bits j = 0; j < 256; ++j) {
      for (int k = 0; k < 8; ++k) {
        const Bits word = static_cast<Bits>(random());
        const Bits a = (i << 23U) | kFractions.at(word % 7);
        const Bits b = (j << 23U) | kFractions.at(word / 7 % 7);
        expect_that_of_the_processor(a | (word & kSign), b | ((word << 1U) & kSign));
      }
    }
  }
}

TEST(SoftFloat, IsThatOfTheProcessorForRandomNumbers) {
  std::mt19937 random(2);
  for (int i = 0; i < 1'000'000; ++i) {
    const Bits a = static_cast<Bits>(random());
    const Bits word = static_cast<Bits>(random());
    // Half of them within 16 binary orders of each other.
    const Bits near = (word & 0x807F'FFFFU) | ((((a >> 23U) + (word >> 27U) - 16U) & 0xFFU) << 23U);
    expect_that_of_the_processor(a, i % 2 == 0 ? word : near);
  }
}

}  // namespace
}  // namespace zerorate::soft_float
