// Ten million sums, differences and products of single precision by the processor, or by what
// stands in for it: a checksum of their bits. Most operands are near each other, some are anything.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "host_tests/emulated/mps2/print.hpp"

namespace {

using Bits = std::uint32_t;

constexpr Bits kNotANumber = 0x7FC0'0000;

/// One pattern for all that is not a number: which one a processor gives is its own affair.
Bits one_pattern(float x) {
  const auto bits = std::bit_cast<Bits>(x);
  return (bits & 0x7FFF'FFFFU) > 0x7F80'0000U ? kNotANumber : bits;
}

class Digest {
 public:
  void add(Bits a, Bits b) {
    // Volatile: computed where the program runs.
    volatile float x = std::bit_cast<float>(a);
    volatile float y = std::bit_cast<float>(b);
    mix(one_pattern(x * y));
    mix(one_pattern(x + y));
    mix(one_pattern(x - y));
  }
  [[nodiscard]] Bits value() const { return value_; }

 private:
  /// FNV-1a, by words: order counts, and every bit does.
  void mix(Bits bits) { value_ = (value_ ^ bits) * 16'777'619U; }
  Bits value_ = 2'166'136'261U;
};

/// Operands that have gone wrong in somebody's floating point before.
constexpr std::array<Bits, 36> kEdges{
    0x0000'0000, 0x0000'0001, 0x0000'0002, 0x0000'0003, 0x003F'FFFF, 0x0040'0000,
    0x007F'FFFE, 0x007F'FFFF, 0x0080'0000, 0x0080'0001, 0x00FF'FFFF, 0x0100'0000,
    0x1980'0000, 0x1FFF'FFFF, 0x2000'0000, 0x33FF'FFFF, 0x3400'0000, 0x3F00'0000,
    0x3F7F'FFFF, 0x3F80'0000, 0x3F80'0001, 0x3FFF'FFFF, 0x4000'0000, 0x4B00'0000,
    0x4B7F'FFFF, 0x4B80'0000, 0x5F00'0000, 0x7E7F'FFFF, 0x7E80'0000, 0x7EFF'FFFF,
    0x7F00'0000, 0x7F7F'FFFE, 0x7F7F'FFFF, 0x7F80'0000, 0x7FC0'0000, 0x7FA0'0001};

Bits edges() {
  Digest digest;
  for (const Bits a : kEdges) {
    for (const Bits b : kEdges) {
      for (const Bits signs : {0U, 1U, 2U, 3U}) {
        digest.add(a | (signs << 31U), b | ((signs >> 1U) << 31U));
      }
    }
  }
  return digest.value();
}

/// @param operand gives a second operand from a random word and the first operand
template <class Operand>
Bits random_operands(std::uint32_t count, Operand operand) {
  Digest digest;
  Bits state = 2'463'534'242;
  const auto next = [&state] {
    state ^= state << 13U;
    state ^= state >> 17U;
    state ^= state << 5U;
    return state;
  };
  for (std::uint32_t i = 0; i < count; ++i) {
    const Bits a = next();
    digest.add(a, operand(next(), a));
  }
  return digest.value();
}

}  // namespace

int main() {
  using zerorate::emulated::write_line;
  constexpr std::uint32_t kRounds = 850'000;  // four times three operations each: ten million
  write_line("edges", edges());
  write_line("anything", random_operands(kRounds, [](Bits word, Bits) { return word; }));
  // Exponents within 16 of each other: aligned, carried, cancelled.
  write_line("near_each_other", random_operands(kRounds, [](Bits word, Bits a) {
               const Bits exponent = ((a >> 23U) + (word >> 27U) - 16U) & 0xFFU;
               return (word & 0x807F'FFFFU) | (exponent << 23U);
             }));
  // Few bits set: ties.
  write_line("ties", random_operands(kRounds, [](Bits word, Bits a) {
               const Bits exponent = ((a >> 23U) + (word & 31U) - 16U) & 0xFFU;
               return (word & 0x8070'0000U) | (exponent << 23U) | ((word >> 8U) & 1U);
             }));
  // Products about the smallest normal number.
  write_line("subnormal", random_operands(kRounds, [](Bits word, Bits a) {
               const Bits exponent = (127U - (a >> 23U) + (word & 31U)) & 0xFFU;
               return (word & 0x807F'FFFFU) | (exponent << 23U);
             }));
  return 0;
}
