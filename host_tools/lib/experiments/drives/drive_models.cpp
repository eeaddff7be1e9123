#include "host_tools/lib/experiments/drives/drive_models.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "host_tools/lib/diagnose/diagnose.hpp"
#include "host_tools/lib/identify/characterize.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::experiments {
namespace {

Fits diagnosed(const identify::RestSamples& samples, const std::string& recording) {
  std::vector<diagnose::Record> axes;
  axes.reserve(samples.axis_count);
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    axes.push_back(diagnose::record_of(samples, axis));
  }
  Fits fits;
  for (auto& diagnosis :
       diagnose::diagnose(std::move(axes), {.recording = recording, .holdout = 0.0})) {
    fits.push_back({recording, fits.size(), std::move(diagnosis.extended_model),
                    std::move(diagnosis.base_model)});
  }
  return fits;
}

}  // namespace

Fits fit_recording(const std::filesystem::path& path, FitBy fit_by) {
  recording::Reader reader{path};
  const identify::RestSamples samples = identify::read_rest_samples(reader);
  if (fit_by == FitBy::diagnosis) return diagnosed(samples, path.filename().string());
  identify::CharacterizeOptions options{.recording = path.filename().string()};
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) options.axes.push_back(axis);
  const auto free_order = identify::characterize(samples, options);
  options.order = 0.5;
  const auto half_order = identify::characterize(samples, options);
  Fits fits;
  for (std::size_t axis = 0; axis < samples.axis_count; ++axis) {
    fits.push_back(
        {options.recording, axis, free_order.axes[axis].model, half_order.axes[axis].model});
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

}  // namespace zerorate::experiments
