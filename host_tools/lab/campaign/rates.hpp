/// @file
/// Shares of runs with their intervals, and stated probabilities against them.
#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace zerorate::campaign {

/// A share of runs.
struct Rate {
  std::size_t hits = 0;
  std::size_t runs = 0;

  void count(bool hit) {
    ++runs;
    if (hit) ++hits;
  }
  [[nodiscard]] double share() const;
  /// The exact 95 % interval of Clopper and Pearson.
  [[nodiscard]] double lo95() const;
  [[nodiscard]] double hi95() const;
};

/// Tests that so many hits, or fewer (more), happen less than once in a thousand campaigns of a
/// tool whose true rate is p. More than that no test of few runs can assert.
[[nodiscard]] bool is_surely_below(const Rate& rate, double p);
[[nodiscard]] bool is_surely_above(const Rate& rate, double p);

/// A share as text, with one decimal.
[[nodiscard]] std::string percent(double share);

/// Stated probabilities of causes against how often they were right: a reliability diagram.
class Reliability {
 public:
  void count(double probability, bool right);
  /// Mean distance between stated and right, weighed by the number of causes.
  [[nodiscard]] double expected_calibration_error() const;
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] std::string markdown() const;

 private:
  struct Bin {
    double stated = 0.0;  ///< sum
    Rate right;
  };
  std::array<Bin, 10> bins_;
};

}  // namespace zerorate::campaign
