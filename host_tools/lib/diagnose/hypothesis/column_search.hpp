/// @file
/// Searching for mean functions: what a further column would gain, by generalised least squares in
/// the DCT domain at a given noise (docs/design/diagnosis.md, section 3).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"

namespace zerorate::diagnose {

class MeanScan {
 public:
  /// Looks for what could be added to a hypothesis.
  explicit MeanScan(const Explanation& explanation);
  /// Looks for what could take the place of a part's columns, the noise being that with the part.
  MeanScan(const Explanation& explanation, std::size_t part);

  [[nodiscard]] const Problem& problem() const { return explanation_->problem(); }
  [[nodiscard]] const std::vector<double>& density() const { return explanation_->density(); }
  [[nodiscard]] const NoiseSpectrum& noise() const { return explanation_->noise().spectrum; }
  /// DCT coefficients of what is to be explained.
  [[nodiscard]] const std::vector<double>& residual() const {
    return is_changed_ ? residual_ : explanation_->residual();
  }
  /// Gain of log likelihood by the best amplitudes of these columns.
  [[nodiscard]] double gain(std::span<const Column> columns) const;
  [[nodiscard]] double gain(const Column& column) const { return gain(std::span(&column, 1)); }
  /// x' Sigma^-1 x of what is left of a column beside those of the hypothesis.
  [[nodiscard]] double information(const Column& column) const;

  /// Sigma^-1 (y - mean), value by value.
  [[nodiscard]] const std::vector<double>& weighted() const;
  /// Gain of a step before each value (position 0 and the last ones included, as 0).
  [[nodiscard]] std::vector<double> step_gains() const;
  /// How often the gain of steps crosses a level G upwards by chance, over e^(-G).
  [[nodiscard]] double step_crossings() const;

 private:
  [[nodiscard]] double product(const Column& a, const Column& b) const;
  [[nodiscard]] double product_with_residual(const Column& column) const;
  [[nodiscard]] Eigen::VectorXd beside(const Column& column) const;
  [[nodiscard]] const std::vector<double>& step_information() const;

  const Explanation* explanation_;
  std::vector<const Column*> others_;
  Eigen::MatrixXd others_covariance_;
  Eigen::VectorXd others_products_;  ///< with the residual
  bool is_changed_ = false;          ///< the residual is not that of the explanation
  std::vector<double> residual_;     ///< then
  mutable std::vector<double> weighted_;
  mutable std::vector<double> step_information_;
};

}  // namespace zerorate::diagnose
