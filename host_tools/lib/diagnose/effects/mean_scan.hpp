/// @file
/// Searching for mean functions: what a further column would gain, by generalised least squares in
/// the DCT domain at a given noise (docs/design/diagnosis.md, section 3).
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host_tools/lib/diagnose/effect.hpp"

namespace zerorate::diagnose {

/// The DCT of a slow function of time given at each value. Of long records it is taken of the means
/// over blocks, and coefficients beyond half of theirs are left out.
[[nodiscard]] Column column_of(const Problem& problem, std::span<const double> values);
/// The same of a function that is smooth over a block.
[[nodiscard]] Column column_of(const Problem& problem,
                               const std::function<double(double time_s)>& function);
/// Of a fast one, with all coefficients.
[[nodiscard]] Column fast_column_of(const Problem& problem,
                                    const std::function<double(double time_s)>& function);
/// Of 0 before value `first` and 1 from it on.
[[nodiscard]] Column step_column(const Problem& problem, std::size_t first);
/// Of cosine and sine of a tone, `cycles` a value; what is far from its frequency is left out.
[[nodiscard]] std::pair<Column, Column> tone_columns(const Problem& problem, double cycles);
/// Of e^(-t / tau).
[[nodiscard]] Column decay_column(const Problem& problem, double tau_s);

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

/// A search that names the best part at the given noise.
using MeanSearch = std::function<std::optional<Part>(const MeanScan&)>;

/// Searches, fits the noise again and searches once more at the new noise; the better one.
[[nodiscard]] std::optional<Offer> offer_of_mean(const Explanation& without,
                                                 const MeanSearch& search);

/// The same with the hypothesis that it makes.
struct FittedOffer {
  Offer offer;
  Explanation with;  ///< the part, which is the last one
};
[[nodiscard]] std::optional<FittedOffer> fitted_offer_of_mean(const Explanation& without,
                                                              const MeanSearch& search);

/// Standard error of a parameter that a column depends on, from the derivative of the mean by it.
[[nodiscard]] double shape_error(const Found& found, const Column& derivative);

/// The mean function of a part over the data, thinned, with the level that the record has.
[[nodiscard]] Drawing drawing_of(const Found& found);

}  // namespace zerorate::diagnose
