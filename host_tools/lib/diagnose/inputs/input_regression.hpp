/// @file
/// Regression of a bias on inputs over all standstills, beside the noise that the node's filter
/// expects.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/record/input_ticks.hpp"

namespace zerorate::diagnose {

/// One input over the ticks. Its level is of no meaning: the bias has that already.
using InputColumn = std::vector<double>;

/// Coefficients of inputs [rad/s per unit], at the greatest likelihood.
struct InputFit {
  std::vector<double> coefficients;
  std::vector<std::vector<double>> covariance;
  double log_likelihood = 0.0;
  model::SensorModel noise{};  ///< white and flicker noise of what they leave
};

/// Fits white noise, flicker noise and the coefficients together: generalised least squares at the
/// noise, and the noise of what they leave, in turns until the likelihood no longer grows. Some 60
/// passes of the filter a turn, five turns at most. Throws recording::DataError for fewer than 64
/// ticks.
/// @param axis  of the rates
/// @param columns  may be none
[[nodiscard]] InputFit fit_inputs(const InputTicks& ticks, std::size_t axis,
                                  std::span<const InputColumn> columns);

/// Factor by which gains are larger than chi squared lets expect, because slow noise between
/// standstills is known from few of them only: the mean gain, in what the fit leaves, of columns
/// whose standstills are exchanged at random, over half their number; at least 1. It is larger by
/// what the fit takes from the scatter of few standstills.
/// @param all  columns of the fit
/// @param columns  those of the effect that is judged
[[nodiscard]] double inflation_of_gains(const InputTicks& ticks, std::size_t axis,
                                        std::span<const InputColumn> all,
                                        std::span<const InputColumn> columns);

/// Log likelihood of the ticks from one on by the filter of the node, whose noise and coefficients
/// are those of a fit to the ticks before it [nats]. Throws recording::DataError where these are
/// fewer than 64.
/// @param first  of the ticks that the fit does not see
[[nodiscard]] double score_of_rest(const InputTicks& ticks, std::size_t axis,
                                   std::span<const InputColumn> columns, std::size_t first);

}  // namespace zerorate::diagnose
