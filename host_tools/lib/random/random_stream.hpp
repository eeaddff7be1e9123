/// @file
/// Random numbers by counting: number k of stream s under seed S is a pure function of (S, s, k).
/// Order of evaluation, number of threads and the C++ library have no influence on any bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace zerorate::random {

/// Philox4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC11): 128 random
/// bits for each 128-bit counter under a 64-bit key.
[[nodiscard]] std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                                      std::array<std::uint32_t, 2> key);

/// The standard normal quantile of p in (0, 1), relative error about 1e-16 (Wichura 1988,
/// algorithm AS 241), from +, -, *, / and the square root only: the same bits
/// on every IEEE 754 machine.
[[nodiscard]] double normal_quantile(double p);

/// An addressable sequence of independent random numbers; a value of 16 bytes, without state.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed, std::uint64_t stream = 0)
      : seed_(seed), stream_(stream) {}

  /// A stream of its own for a part or a run; the numbers of this one are not used up.
  [[nodiscard]] RandomStream substream(std::uint64_t id) const;
  [[nodiscard]] RandomStream substream(std::string_view name) const;

  /// The k-th number: 64 bits; uniform in (0, 1), neither end ever; standard normal. The three are
  /// functions of the same bits: take one of them for each k. k may be negative.
  [[nodiscard]] std::uint64_t bits(std::int64_t k) const;
  [[nodiscard]] double uniform(std::int64_t k) const;
  [[nodiscard]] double normal(std::int64_t k) const;

  /// normal(first), normal(first + 1), ... at half the cost a number.
  void fill_normal(std::int64_t first, std::span<double> values) const;

 private:
  [[nodiscard]] std::array<std::uint64_t, 2> pair(std::int64_t index) const;

  std::uint64_t seed_;
  std::uint64_t stream_;
};

}  // namespace zerorate::random
