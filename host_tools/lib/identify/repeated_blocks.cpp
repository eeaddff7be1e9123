#include "host_tools/lib/identify/repeated_blocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>

namespace zerorate::identify {
namespace {

constexpr std::size_t kMostRows = 4'000'000;

/// Rows of a recording, compared bit by bit.
class Rows {
 public:
  explicit Rows(const RestSamples& samples)
      : samples_(samples), size_(std::min(samples.time.size(), kMostRows)) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool are_equal(std::size_t one, std::size_t other) const {
    return samples_.rate_rad_s[one] == samples_.rate_rad_s[other];
  }
  [[nodiscard]] std::uint64_t hash(std::size_t k) const {
    constexpr std::uint64_t kFactor = 0x9E3779B97F4A7C15U;
    std::uint64_t hash = 0;
    for (std::size_t i = 0; i < samples_.axis_count; ++i) {
      hash = (hash ^ std::bit_cast<std::uint32_t>(samples_.rate_rad_s[k][i])) * kFactor;
      hash ^= hash >> 29U;
    }
    return hash;
  }
  [[nodiscard]] core::Duration between(std::size_t one, std::size_t other) const {
    return samples_.time[other] - samples_.time[one];
  }
  /// Share of the pairs of rows so far apart that are equal.
  [[nodiscard]] double equal_share(std::size_t apart) const {
    std::size_t equal = 0;
    for (std::size_t k = apart; k < size_; ++k) equal += are_equal(k, k - apart) ? 1U : 0U;
    return static_cast<double>(equal) / static_cast<double>(size_ - apart);
  }

 private:
  const RestSamples& samples_;
  std::size_t size_;
};

/// Rows in a row that are not equal by chance; none where that cannot be said.
std::optional<std::size_t> rows_beyond_chance(const Rows& rows) {
  constexpr std::size_t kFewest = 16;
  constexpr double kChance = 1e-9;
  constexpr double kCaution = 4.0;
  // The least of several: a buffer that comes again makes rows equal at the multiples of its size.
  constexpr std::array<std::size_t, 4> kApart{211, 499, 997, 1999};
  if (rows.size() <= 2 * kApart.back()) return std::nullopt;
  double equal = 1.0;
  for (const std::size_t apart : kApart) equal = std::min(equal, rows.equal_share(apart));
  if (equal > 0.5) return std::nullopt;
  const auto size = static_cast<double>(rows.size());
  const double found = std::log(2.0 * kChance / (size * size)) / std::log(std::max(equal, 1e-6));
  return std::max(kFewest, static_cast<std::size_t>(std::ceil(kCaution * found)));
}

/// Copies that were found.
struct Copies {
  std::size_t rows = 0;
  std::size_t blocks = 0;
  std::size_t first = 0;  ///< row at which the first one begins
  std::size_t apart = 0;  ///< rows from its original to it
};

/// Windows of equal rows, each looked for where its first row's hash has four bits of zero, so that
/// a copy is looked for at the same rows as its original.
class CopyFinder {
 public:
  CopyFinder(const Rows& rows, std::size_t window) : rows_(rows), window_(window) {}

  [[nodiscard]] Copies find() {
    for (std::size_t k = 0; k + window_ <= rows_.size();) k = look_at(k);
    return found_;
  }

 private:
  /// Gives the next row to look at.
  std::size_t look_at(std::size_t k) {
    constexpr std::uint64_t kAnchors = 0xFU << 20U;
    if ((rows_.hash(k) & kAnchors) != 0) return k + 1;
    const auto [seen, is_new] = seen_.try_emplace(hash_of_window(k), k);
    if (is_new) return k + 1;
    const std::size_t original = seen->second;
    std::size_t size = 0;
    while (k + size < rows_.size() && rows_.are_equal(original + size, k + size)) ++size;
    if (size < window_) return k + 1;
    std::size_t before = 0;
    while (before < original && k - before > end_ &&
           rows_.are_equal(original - before - 1, k - before - 1)) {
      ++before;
    }
    if (found_.blocks++ == 0) found_ = {0, 1, k - before, k - original};
    found_.rows += before + size;
    end_ = k + size;
    return end_;
  }
  [[nodiscard]] std::uint64_t hash_of_window(std::size_t k) const {
    std::uint64_t hash = 0;
    for (std::size_t i = 0; i < window_; ++i) hash = std::rotl(hash, 7) ^ rows_.hash(k + i);
    return hash;
  }

  const Rows& rows_;
  std::size_t window_;
  std::unordered_map<std::uint64_t, std::size_t> seen_;  ///< first row of each window
  std::size_t end_ = 0;                                  ///< end of the newest copy
  Copies found_;
};

}  // namespace

std::optional<RestDoubt> doubt_of_repeated_blocks(const RestSamples& samples) {
  constexpr double kCertain = 0.01;
  const Rows rows{samples};
  const std::optional<std::size_t> window = rows_beyond_chance(rows);
  if (!window) return std::nullopt;
  const Copies copies = CopyFinder{rows, *window}.find();
  if (copies.blocks == 0) return std::nullopt;
  const double share = static_cast<double>(copies.rows) / static_cast<double>(rows.size());
  return RestDoubt{
      doubt::kCopies,
      fmt::format("{} rows ({:.2g} %) are, in order and bit by bit, those of an earlier place; the "
                  "first copies begin at {:.6g} s, {} rows behind their originals: a buffer that "
                  "was written again? It holds no new measurement. Cut the copies off",
                  copies.rows, 100.0 * share,
                  static_cast<double>(rows.between(0, copies.first).ns()) * 1e-9, copies.apart),
      share >= kCertain};
}

}  // namespace zerorate::identify
