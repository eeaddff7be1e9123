/// @file
/// The models that the contestants of a contest on drives run.
#pragma once

#include <filesystem>
#include <vector>

#include "host_tools/lib/contest/drives.hpp"

namespace zerorate::contest {

/// Models of one recording, by axis.
using Fits = std::vector<DriveContest::AxisModels>;

/// Input of a recording of a contest.
[[nodiscard]] recording::Input input_of(const std::filesystem::path& path,
                                        const DriveContestOptions& options);

/// Fits each axis of a recording. Throws recording::DataError that names it, also for a sensor that
/// moved: its drives would be scored as errors.
[[nodiscard]] Fits fit_recording(const std::filesystem::path& path, FitBy fit_by,
                                 const DriveContestOptions& options);

/// Whether a recording may use the fit and the tuning of the lender on an axis.
[[nodiscard]] bool lends_to(const std::vector<Fits>& fits, FitOn fit_on, std::size_t lender,
                            std::size_t recording, std::size_t axis);

/// Models of an axis that a recording may use; none where no other recording has that axis.
[[nodiscard]] std::vector<model::SensorModel> lent_models(
    const std::vector<Fits>& fits, FitOn fit_on, std::size_t recording, std::size_t axis,
    model::SensorModel DriveContest::AxisModels::*which);

/// Models that a recording runs: the mean of the lent ones where all are white and flicker noise
/// and nothing else, otherwise each in its turn, since models of several kinds have no mean.
[[nodiscard]] std::vector<model::SensorModel> shared_models(std::vector<model::SensorModel> lent);

/// Mean of models: of log N, log B and d, which is the mean of the log spectra at every frequency.
/// Recordings that showed no flicker noise have no say in it.
/// @param models  at least one
[[nodiscard]] model::SensorModel mean_model(const std::vector<model::SensorModel>& models);

}  // namespace zerorate::contest
