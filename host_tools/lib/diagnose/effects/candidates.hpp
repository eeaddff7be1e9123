/// @file
/// Candidates and figures of effects, both changes of the spectrum and mean functions of time or
/// temperature.
#pragma once

#include <optional>
#include <string>

#include "host_tools/lib/diagnose/effects/effect.hpp"
#include "host_tools/lib/diagnose/hypothesis/column_search.hpp"
#include "host_tools/lib/diagnose/hypothesis/fit_data.hpp"
#include "host_tools/lib/diagnose/hypothesis/linear_model.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// Candidate of a part that is added to a hypothesis: its gain, without the surprisal. One fit.
[[nodiscard]] Candidate candidate_with(const Hypothesis& without, Part part);

/// Candidate of a part that has to be placed. The fitted noise becomes its only start, so that
/// later fits need not search again. One fit.
[[nodiscard]] Candidate placed_candidate(const Hypothesis& without, Part part);

/// Candidate for a fitted mean; the surprisal is not set.
[[nodiscard]] std::optional<Candidate> mean_candidate(const Hypothesis& without,
                                                      const MeanSearch& search);

/// Candidate for a fitted mean with one amplitude and a time constant that was searched between two
/// ends; the surprisal is set.
[[nodiscard]] std::optional<Candidate> timed_mean_candidate(const Hypothesis& without,
                                                            const MeanSearch& search,
                                                            double shortest, double longest);

/// Standard error of a parameter that a column depends on, from the derivative of the mean by it.
[[nodiscard]] double shape_error(const FittedPart& fitted, const Column& derivative);

/// The mean function of a part over the data, thinned, with the level that the record has.
[[nodiscard]] Drawing drawing_of(const FittedPart& fitted);

/// A positive parameter with the interval value * exp(+-1.96 log_error).
/// @param log_error  standard error of the logarithm
[[nodiscard]] Parameter positive_parameter(std::string name, double value, double log_error);

/// A parameter with the interval value +- 1.96 standard_error.
[[nodiscard]] Parameter parameter(std::string name, double value, double standard_error);

/// Fall of the gain to the ends of the interval of a place [nats]. A place is not regular: half the
/// quantile of chi squared, 1.92 nats, would be too few (Siegmund 1988).
inline constexpr double kIntervalOfPlace_nats = 3.0;

/// Filter tick of the node when it runs a model of this record [s].
[[nodiscard]] double node_tick_s(const FitData& data);

/// Standard deviation of a transient's or a ramp's size at the next start, relative to its size.
inline constexpr double kShareOfNextStart = 0.3;

}  // namespace zerorate::diagnose
