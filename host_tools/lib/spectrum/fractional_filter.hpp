/// @file
/// The fractional power of a sum or of a difference, (1 - L)^{-d}: what makes 1/f noise out of
/// white noise (d > 0) and takes it away again (d < 0). L is the lag of one sample.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace zerorate::spectrum {

/// The impulse response of (1 - L)^{-d}, one coefficient after the other:
/// psi_0 = 1, psi_j = psi_{j-1} (j - 1 + d) / j   (Kirkko-Jaakkola et al. 2012, eq. 3; Hosking
/// 1981).
class FractionalWeights {
 public:
  explicit FractionalWeights(double order) : order_(order) {}
  /// psi_0 at the first call, then psi_1, ...
  double next() {
    const double weight = weight_;
    ++index_;
    weight_ *= (index_ - 1.0 + order_) / index_;
    return weight;
  }

 private:
  double order_;
  double index_ = 0.0;
  double weight_ = 1.0;
};

/// Fills a block with the input's samples first, first + 1, ...; first may be negative.
using BlockSource = std::function<void(std::ptrdiff_t first, std::span<double> block)>;

/// y_k = sum_{j=0}^{k + history} psi_j u_{k-j} for k = 0 .. size-1: the input u is zero before
/// -history. Fast convolution in partitions (overlap-save), the lag in the outer loop, so that the
/// memory does not depend on the history. Time O(n log n + n (n + history) / 65536); memory four
/// doubles a sample beside the output.
void integrate_fractionally(double order, const BlockSource& input, std::size_t history,
                            std::span<double> output);

/// (1 - L)^d of a sequence that is zero before its first sample; d < 0 integrates.
[[nodiscard]] std::vector<double> difference_fractionally(double order,
                                                          std::span<const double> values);

}  // namespace zerorate::spectrum
