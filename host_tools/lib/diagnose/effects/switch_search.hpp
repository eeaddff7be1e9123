/// @file
/// The best path between two levels in noise of a given density, by generalised least squares.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "host_tools/lib/spectrum/transforms.hpp"

namespace zerorate::diagnose {

/// Places before which the level changes, in rising order. They do not say which level is the upper
/// one.
using Switches = std::vector<std::size_t>;

/// -log P of so many switches among `size` places under the best Markov chain, less the uncertainty
/// of their places. The place of a jump of height h in white noise r is known to about 4 r / h^2
/// values, but at least to a quarter of a stay: otherwise the stays could not be distinguished.
[[nodiscard]] double price_of_switches(std::size_t count, std::size_t size,
                                       double white_over_square);

/// Searches by adding, taking away and moving switches as long as gain less price grows. A path of
/// K switches costs O(K^2), since the product of two steps in stationary noise is a function of
/// their distance and of their sum (docs/design/diagnosis.md, section 3).
class SwitchSearch {
 public:
  /// @param coefficients  DCT of the residual to be explained
  /// @param density  density of the noise at each coefficient; the first is not used
  /// @param white_variance  white variance of the noise
  SwitchSearch(const spectrum::CosineTransform& transform, std::span<const double> coefficients,
               std::span<const double> density, double white_variance);

  /// The best path that is reached from this one.
  [[nodiscard]] Switches improve(Switches path) const;

 private:
  /// Products of a path with the record and with itself.
  struct Products {
    double record = 0.0;
    double itself = 0.0;
  };
  struct Move {
    double score = 0.0;
    Switches path;
  };

  [[nodiscard]] std::size_t size() const { return record_.size() - 1; }
  /// Product of two steps.
  [[nodiscard]] double product(std::size_t a, std::size_t b) const;
  /// Product of a path with a step.
  [[nodiscard]] double product(const Switches& path, std::size_t step) const;
  [[nodiscard]] Products products(const Switches& path) const;
  [[nodiscard]] double score(const Products& products, std::size_t count) const;
  [[nodiscard]] double score(const Switches& path) const {
    return score(products(path), path.size());
  }
  [[nodiscard]] Move best_addition(const Switches& path) const;
  [[nodiscard]] Move best_removal(const Switches& path) const;
  /// Moves every switch to its best place between its neighbours.
  void settle(Switches& path) const;

  std::vector<double> record_;    ///< products of the record with a step before each value
  std::vector<double> distance_;  ///< products of steps, by sum and difference of place
  double white_variance_ = 0.0;
};

}  // namespace zerorate::diagnose
