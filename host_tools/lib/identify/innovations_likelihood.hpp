/// @file
/// The exact likelihood of a sensor model: that of the innovations of the node's own filter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/time.hpp"
#include "core/noise/model_shape.hpp"
#include "core/samples/tick_average.hpp"
#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"

namespace zerorate::identify {

/// Likelihood of a record under a model. With e_k the innovation and S_k its predicted variance,
///
///     -2 log L = sum over k of log S_k + e_k^2 / S_k,
///
/// without the constant n log 2 pi. The first measurement is left out: the bias is diffuse before
/// it, so that L is the density of all differences from it (docs/design/identification.md, eq. 1).
struct Likelihood {
  double log_variances = 0.0;        ///< sum of log S_k
  double squared_innovations = 0.0;  ///< sum of e_k^2 / S_k: about `innovations` if S is right
  std::size_t innovations = 0;

  [[nodiscard]] double minus_two_log() const { return log_variances + squared_innovations; }
};

/// Innovation of a tick: what the filter did not predict, and the variance that it predicted of it.
struct TickInnovation {
  double residual_rad_s = 0.0;
  double variance_rad2_s2 = 0.0;
};

/// Ticks of one axis, to be run through app::TickNode: a tick of few samples has more white noise,
/// a gap or a drive is one step over many ticks.
class InnovationsLikelihood {
 public:
  /// @param ticks in order, at least two; throws recording::DataError otherwise
  /// @param tick, sample_period as the ticks were averaged
  InnovationsLikelihood(std::span<const TickMean> ticks, std::size_t axis,
                        core::Duration sample_period, core::Duration tick);

  /// One pass of the filter, single precision like the node; the sums are double. About 0.1 us a
  /// tick. The rounding of the filter leaves the result rough, by 1e-4 to 0.1 at 2 x 10^4 ticks:
  /// compare models whose likelihoods differ by more.
  /// Throws std::invalid_argument for a model that the node cannot run (see make_node_model).
  [[nodiscard]] Likelihood operator()(const model::SensorModel& model) const;

  /// Innovations of the ticks behind the first. They are linear in the rates, and their variances
  /// do not depend on these: a regression on them is one of generalised least squares. Throws as
  /// above.
  [[nodiscard]] std::vector<TickInnovation> innovations(const model::SensorModel& model) const;

  [[nodiscard]] std::size_t ticks() const { return ticks_.size(); }
  [[nodiscard]] core::Duration tick() const { return tick_; }
  [[nodiscard]] core::Duration sample_period() const { return sample_period_; }

 private:
  /// Calls take(TickInnovation) for each tick behind the first.
  template <class Take>
  void for_each_innovation(const model::SensorModel& model, Take take) const;

  std::vector<core::TickMean<1>> ticks_;
  core::Duration sample_period_;
  core::Duration tick_;
};

}  // namespace zerorate::identify
