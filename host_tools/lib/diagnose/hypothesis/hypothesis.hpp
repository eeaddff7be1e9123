/// @file
/// A hypothesis about a record: noise, mean functions and disturbed samples, fitted together.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/noise_spectrum.hpp"
#include "host_tools/lib/diagnose/record/even_series.hpp"
#include "host_tools/lib/diagnose/record/level_lattice.hpp"
#include "host_tools/lib/spectrum/cosine_transform.hpp"

namespace zerorate::diagnose {

/// What all hypotheses about a record share.
class Problem {
 public:
  /// All but the last few values of the series are used (spectrum::fast_length_below).
  Problem(const EvenSeries& series, std::uint64_t seed);

  [[nodiscard]] std::size_t size() const { return rate_.size(); }
  [[nodiscard]] double period_s() const { return series_->period_s; }
  [[nodiscard]] double time_s(std::size_t k) const {
    return series_->period_s * static_cast<double>(k);
  }
  [[nodiscard]] double span_s() const { return time_s(size()); }
  [[nodiscard]] const EvenSeries& series() const { return *series_; }
  /// Of the values that are used, those that are lost.
  [[nodiscard]] const std::shared_ptr<const std::vector<bool>>& lost() const { return lost_; }
  /// Deviation from the median [rad/s].
  [[nodiscard]] const std::vector<double>& rate_rad_s() const { return rate_; }
  [[nodiscard]] double median_rad_s() const { return median_; }
  /// The same without the lost values.
  [[nodiscard]] std::vector<double> measured() const;
  /// What the measured values lie on; nothing for means over ticks.
  [[nodiscard]] const std::optional<LevelLattice>& lattice() const { return lattice_; }
  [[nodiscard]] const spectrum::CosineTransform& transform() const { return transform_; }
  /// Slow functions are known well enough by their means over blocks of so many values: 1 up to
  /// some 10^5 values.
  [[nodiscard]] std::size_t block() const { return block_; }
  /// The transform of one value a block.
  [[nodiscard]] const spectrum::CosineTransform& block_transform() const {
    return block_transform_ ? *block_transform_ : transform_;
  }
  /// 2 sin(w/2) of each DCT coefficient.
  [[nodiscard]] const std::vector<double>& sines() const { return sines_; }
  [[nodiscard]] std::uint64_t seed() const { return seed_; }

 private:
  const EvenSeries* series_;
  std::vector<double> rate_;
  std::shared_ptr<const std::vector<bool>> lost_;
  double median_ = 0.0;
  std::optional<LevelLattice> lattice_;
  spectrum::CosineTransform transform_;
  std::size_t block_ = 1;
  std::optional<spectrum::CosineTransform> block_transform_;
  std::vector<double> sines_;
  std::uint64_t seed_;
};

/// A function of time as DCT coefficients; those outside are nothing.
struct Column {
  std::size_t first = 1;
  std::vector<double> coefficients;

  [[nodiscard]] std::size_t end() const { return first + coefficients.size(); }
};

/// Neighbouring values [first, end).
struct Run {
  std::size_t first = 0;
  std::size_t end = 0;
};

/// The range of what could be measured, about the median of the record [rad/s].
struct Range {
  double lo = -std::numeric_limits<double>::infinity();
  double hi = std::numeric_limits<double>::infinity();

  bool operator==(const Range&) const = default;
};

/// What an effect contributes to a hypothesis. Most effects use one or two of the members.
struct Part {
  std::string_view effect;
  NoiseTerms terms;
  std::vector<NoiseSpectrum> starts;  ///< for the terms
  std::vector<Column> columns;        ///< mean functions, whose amplitudes are fitted
  std::vector<double> shape;          ///< what else the effect wants to remember, its own affair
  std::vector<Run> replaced;          ///< values that say nothing of the noise
  Range clipped;                      ///< replaced values at its ends are known to lie beyond them
  std::vector<float> relative_sigma;  ///< of the white noise, one a value; empty: 1
};

/// Parts with everything that can be fitted. What is as long as the record is shared among copies,
/// and among hypotheses that agree on it.
class Explanation {
 public:
  /// Fits the noise and all amplitudes: generalised least squares and Whittle fit in turn.
  /// @param before from which the noise is started, if there is one
  Explanation(const Problem& problem, std::vector<Part> parts, const Explanation* before = nullptr);

  /// Noise of a given density, S_k by index; of it nothing is fitted, and noise() tells nothing.
  /// The amplitudes of the parts are fitted.
  Explanation(const Problem& problem, std::vector<Part> parts, std::vector<double> density);

  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] const SpectrumFit& noise() const { return noise_; }
  [[nodiscard]] const NoiseTerms& terms() const { return terms_; }
  [[nodiscard]] double log_likelihood() const { return noise_.log_likelihood; }

  /// The same sum over single coefficients, not over bins, whatever the noise comes from.
  [[nodiscard]] double log_likelihood_of_coefficients() const;

  /// Position of a part's amplitudes among all, and the amplitudes with their covariance.
  [[nodiscard]] std::size_t first_amplitude(std::size_t part) const;
  [[nodiscard]] const Eigen::VectorXd& amplitudes() const { return amplitudes_; }
  [[nodiscard]] const Eigen::MatrixXd& amplitude_covariance() const { return covariance_; }

  /// The record, disturbed values replaced [rad/s, about the median].
  [[nodiscard]] const std::vector<double>& clean() const { return *clean_; }
  /// DCT coefficients without the mean functions; c_0 is 0.
  [[nodiscard]] const std::vector<double>& residual() const { return *residual_; }
  /// S_k; S_0 is infinite.
  [[nodiscard]] const std::vector<double>& density() const;
  /// Residual with its spectrum made flat: independent, of variance 1 under the hypothesis.
  [[nodiscard]] const std::vector<double>& whitened() const;
  /// Sigma^-1 (y - mean), value by value.
  [[nodiscard]] const std::vector<double>& weighted() const;
  /// The diagonal of Sigma^-1: a value predicted from all others has the variance 1 / this.
  [[nodiscard]] double information() const;
  /// The values lie on levels so coarse that rounding changes their distribution and its spread by
  /// more than this record's chance: single values tell of the levels, not of the noise.
  [[nodiscard]] bool is_coarse() const;
  /// What rounding alone may do to a level where the values are coarse: one step; else nothing.
  [[nodiscard]] double rounding_rad_s() const {
    return is_coarse() ? problem_->lattice()->step : 0.0;
  }
  /// Residual of the part of the spectrum where white noise prevails, made flat; variance 1.
  struct FastResidual {
    std::vector<double> values;
    double degrees_of_freedom_per_value = 1.0;
  };
  [[nodiscard]] FastResidual fast_residual() const;
  /// Values that are replaced, by any part, or lost.
  [[nodiscard]] const std::vector<bool>& is_replaced() const { return *is_replaced_; }

 private:
  using Values = std::shared_ptr<const std::vector<double>>;

  void mark_replaced();
  void transform_clean();
  [[nodiscard]] Range clipped() const;
  [[nodiscard]] std::vector<double> replace_values() const;
  void fit(const Explanation* before);
  void fit_amplitudes();
  void subtract_means(std::vector<double>& residual) const;
  [[nodiscard]] std::vector<SpectralBin> bins() const;
  [[nodiscard]] std::vector<const Column*> columns() const;
  [[nodiscard]] std::size_t end_of_columns() const;
  [[nodiscard]] std::vector<double> density_below(std::size_t end) const;

  const Problem* problem_;
  std::vector<Part> parts_;
  NoiseTerms terms_;
  SpectrumFit noise_;
  Eigen::VectorXd amplitudes_;
  Eigen::MatrixXd covariance_;
  std::shared_ptr<const std::vector<bool>> is_replaced_;
  Values clean_;
  Values coefficients_;  ///< of what is clean
  Values residual_;
  mutable Values density_;  ///< this one and the next are made when they are asked for
  mutable Values whitened_;
  mutable Values weighted_;
  mutable std::optional<double> information_;
};

}  // namespace zerorate::diagnose
