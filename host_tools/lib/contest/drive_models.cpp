#include "host_tools/lib/contest/drive_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/identify/rest_check.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::contest {
namespace {

std::vector<model::SensorModel> characterized(const identify::RestSamples& samples,
                                              const std::string& recording,
                                              std::optional<double> order) {
  identify::CharacterizeOptions options{.recording = recording, .order = order};
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) options.axes.push_back(axis);
  std::vector<model::SensorModel> models;
  for (auto& axis : identify::characterize(samples, options).axes) {
    models.push_back(std::move(axis.model));
  }
  return models;
}

std::vector<model::SensorModel> diagnosed(const identify::RestSamples& samples,
                                          const std::string& recording) {
  std::vector<diagnose::Record> axes;
  axes.reserve(samples.axis_count);
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    axes.push_back(diagnose::record_of(samples, axis));
  }
  std::vector<model::SensorModel> models;
  for (auto& diagnosis : diagnose::diagnose(std::move(axes), {.recording = recording})) {
    models.push_back(std::move(diagnosis.extended_model));
  }
  return models;
}

/// Throws recording::DataError for a recording in which the sensor moved.
void require_rest(const identify::RestSamples& samples, const std::string& recording) {
  if (samples.moving > 0) {
    throw recording::DataError(fmt::format(
        "{}: by its odometer the vehicle moved, or was about to, in {} of {} rows, and drives are "
        "cut out of recordings at rest: cut the recording to its rest, or score its own drives: "
        "zerorate replay",
        recording, samples.moving, samples.rows));
  }
  try {
    std::vector<std::size_t> axes = identify::axes_called("all", samples.axis_count);
    const std::vector<std::string> doubts = identify::require_rest(samples, {}, axes);
    if (axes.size() < samples.axis_count) throw recording::DataError(doubts.front());
  } catch (const recording::DataError& error) {
    const std::string sentence = error.what();
    const std::string fault = sentence.substr(0, sentence.find(". Say when it stood"));
    throw recording::DataError(fmt::format(
        "{}: {}. Drives are cut out of recordings at rest: cut the recording to its rest, or score "
        "its own drives: zerorate replay",
        recording, fault));
  }
}

/// White and flicker noise and nothing else.
bool is_plain(const model::SensorModel& model) {
  return model ==
         model::SensorModel{.name = model.name, .white = model.white, .flicker = model.flicker};
}

}  // namespace

recording::Input input_of(const std::filesystem::path& path, const DriveContestOptions& options) {
  recording::Input input = options.format;
  input.path = path;
  return input;
}

Fits fit_recording(const std::filesystem::path& path, FitBy fit_by,
                   const DriveContestOptions& options) {
  recording::Reader reader{input_of(path, options)};
  const identify::RestSamples samples = identify::read_rest_samples(reader);
  const std::string recording = path.filename().string();
  const auto axes = identify::axes_called(options.axis, samples.axis_count);
  require_rest(samples, path.string());
  const auto extended = fit_by == FitBy::diagnosis
                            ? diagnosed(samples, recording)
                            : characterized(samples, recording, std::nullopt);
  const auto base = characterized(samples, recording, 0.5);
  Fits fits;
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    const bool is_scored = std::ranges::find(axes, axis) != axes.end();
    fits.push_back({recording, axis, is_scored, extended[axis], base[axis]});
  }
  return fits;
}

bool lends_to(const std::vector<Fits>& fits, FitOn fit_on, std::size_t lender,
              std::size_t recording, std::size_t axis) {
  if (fit_on == FitOn::itself) return lender == recording;
  return lender != recording && axis < fits[lender].size();
}

std::vector<model::SensorModel> lent_models(const std::vector<Fits>& fits, FitOn fit_on,
                                            std::size_t recording, std::size_t axis,
                                            model::SensorModel DriveContest::AxisModels::*which) {
  std::vector<model::SensorModel> lent;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (lends_to(fits, fit_on, i, recording, axis)) lent.push_back(fits[i][axis].*which);
  }
  return lent;
}

std::vector<model::SensorModel> shared_models(std::vector<model::SensorModel> lent) {
  if (!std::ranges::all_of(lent, is_plain)) return lent;
  return {mean_model(lent)};
}

model::SensorModel mean_model(const std::vector<model::SensorModel>& models) {
  double log_n = 0.0;
  double log_b = 0.0;
  double order = 0.0;
  double with_flicker = 0.0;
  model::SensorModel mean = models.front();
  for (const auto& model : models) {
    log_n += std::log(model.white.angle_random_walk_rad_per_sqrt_s);
    if (!model.flicker) continue;
    mean.flicker = model.flicker;
    log_b += std::log(model.flicker->bias_instability_rad_s);
    order += model.flicker->order;
    ++with_flicker;
  }
  mean.white.angle_random_walk_rad_per_sqrt_s =
      std::exp(log_n / static_cast<double>(models.size()));
  if (mean.flicker) {
    mean.flicker->bias_instability_rad_s = std::exp(log_b / with_flicker);
    mean.flicker->order = order / with_flicker;
  }
  return mean;
}

}  // namespace zerorate::contest
