/// @file
/// A hypothesis about a record: noise, mean functions and disturbed samples, fitted together.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"
#include "host_tools/lib/diagnose/hypothesis/part.hpp"
#include "host_tools/lib/diagnose/hypothesis/spectrum_fit.hpp"
#include "host_tools/lib/parallel/parallel.hpp"

namespace zerorate::diagnose {

/// Parts with everything that can be fitted. Arrays as long as the record are shared among copies,
/// and among hypotheses that agree on them. Threads may share a const object.
class Hypothesis {
 public:
  /// Fits the noise and all amplitudes: generalised least squares and Whittle fit in turn.
  /// @param data must outlive the hypothesis
  /// @param before hypothesis from whose noise the fit starts, if there is one
  Hypothesis(const FitData& data, std::vector<Part> parts, const Hypothesis* before = nullptr);

  /// Takes noise of a given density, S_k by index, which is not fitted: noise() is meaningless
  /// then. The amplitudes of the parts are fitted.
  Hypothesis(const FitData& data, std::vector<Part> parts, std::vector<double> density);

  /// This hypothesis with one more part, fitted from the noise of this one.
  [[nodiscard]] Hypothesis with(Part part) const;

  [[nodiscard]] const FitData& data() const { return *data_; }
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] const SpectrumFit& noise() const { return noise_; }
  [[nodiscard]] const NoiseTerms& terms() const { return terms_; }
  [[nodiscard]] double log_likelihood() const { return noise_.log_likelihood; }

  /// Log likelihood summed over coefficients instead of bins; valid for a given density too.
  [[nodiscard]] double log_likelihood_of_coefficients() const;

  /// Place of a part's amplitudes among all.
  [[nodiscard]] std::size_t first_amplitude(std::size_t part) const;
  /// Amplitudes of all columns, part by part, with their variances.
  [[nodiscard]] const std::vector<double>& amplitudes() const { return amplitudes_; }
  [[nodiscard]] const std::vector<double>& amplitude_variances() const { return variances_; }

  /// The record with disturbed values replaced [rad/s, about the median].
  [[nodiscard]] const std::vector<double>& repaired_values() const { return *repaired_; }
  /// DCT coefficients without the mean functions; c_0 is 0.
  [[nodiscard]] const std::vector<double>& residual() const { return *residual_; }
  /// S_k; S_0 is infinite.
  [[nodiscard]] const std::vector<double>& density() const;
  /// 1 / S_k.
  [[nodiscard]] const std::vector<double>& precision() const;
  /// Residual with its spectrum made flat: independent, of variance 1 under the hypothesis.
  [[nodiscard]] const std::vector<double>& whitened() const;
  /// Sigma^-1 x, value by value, of a function x with these DCT coefficients.
  [[nodiscard]] std::vector<double> precision_weighted(std::vector<double> coefficients) const;
  /// Sigma^-1 (y - mean).
  [[nodiscard]] const std::vector<double>& precision_weighted_residual() const;
  /// Diagonal of Sigma^-1: a value predicted from all others has the variance 1 / mean_precision().
  [[nodiscard]] double mean_precision() const;
  /// True if the values lie on levels so coarse that rounding changes their distribution and its
  /// spread by more than this record's chance: single values depend on the levels, not on the
  /// noise.
  [[nodiscard]] bool is_coarse() const;
  /// Largest change of a value by rounding: one step where the values are coarse, else 0.
  [[nodiscard]] double rounding_rad_s() const { return is_coarse() ? data_->lattice()->step : 0.0; }
  /// Residual of the part of the spectrum where white noise prevails, made flat; variance 1.
  struct WhiteBandResidual {
    std::vector<double> values;
    double degrees_of_freedom_per_value = 1.0;
  };
  [[nodiscard]] WhiteBandResidual white_band_residual() const;
  /// Marks of the values that are lost, or replaced by any part.
  [[nodiscard]] const std::vector<bool>& is_replaced() const { return *is_replaced_; }

 private:
  using Values = std::shared_ptr<const std::vector<double>>;

  void mark_replaced();
  void repair_values();
  [[nodiscard]] Range clipped() const;
  void fit(const Hypothesis* before);
  void fit_amplitudes();
  void subtract_means(std::vector<double>& residual) const;
  [[nodiscard]] std::vector<SpectralBin> bins() const;
  [[nodiscard]] std::vector<NoiseSpectrum> starts(std::span<const SpectralBin> bins,
                                                  const Hypothesis* before) const;
  [[nodiscard]] std::vector<const Column*> columns() const;
  [[nodiscard]] std::size_t end_of_columns() const;
  [[nodiscard]] std::vector<double> density_below(std::size_t end) const;

  const FitData* data_;
  std::vector<Part> parts_;
  NoiseTerms terms_;
  SpectrumFit noise_;
  std::vector<double> amplitudes_;
  std::vector<double> variances_;
  std::shared_ptr<const std::vector<bool>> is_replaced_;
  Values repaired_;
  Values coefficients_;  ///< coefficients of the repaired values
  Values residual_;
  Values given_density_;  ///< null where the noise is fitted
  parallel::Lazy<std::vector<double>> density_;
  parallel::Lazy<std::vector<double>> precision_;
  parallel::Lazy<std::vector<double>> whitened_;
  parallel::Lazy<std::vector<double>> precision_weighted_residual_;
  parallel::Lazy<double> mean_precision_;
};

/// Residual of a record under a hypothesis, which must outlive it.
struct StandardisedResidual {
  explicit StandardisedResidual(const Hypothesis& of);

  const Hypothesis* hypothesis;
  std::vector<double> values;  ///< whitened and divided by the relative sigma: independent, N(0, 1)
};

}  // namespace zerorate::diagnose
