#include "host_tools/lab/paper/measured_sets.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include "host_tools/lab/paper/predictors.hpp"
#include "host_tools/lib/identify/whittle.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::paper {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;
using Eigen::MatrixXd;

using units::kDegPerRad;

std::vector<fs::path> recording_files(const std::vector<fs::path>& paths) {
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    const auto first = static_cast<std::ptrdiff_t>(files.size());
    for (const auto& entry : fs::directory_iterator{path}) {
      const std::string name = entry.path().filename().string();
      if (name.ends_with(".csv") || name.ends_with(".csv.gz")) files.push_back(entry.path());
    }
    std::sort(files.begin() + first, files.end());
  }
  return files;
}

/// Nothing if the first rows show a higher rate.
std::optional<RestRecording> read_rest_recording(const fs::path& path, double highest_rate_hz) {
  constexpr std::uint64_t kRowsThatShowTheRate = 100;
  recording::Reader reader{path};
  RestRecording rest{.name = path.filename().string()};
  rest.axes.resize(reader.columns().axis_count);
  for (recording::Row row; reader.next(row);) {
    if (reader.findings().rows() == kRowsThatShowTheRate &&
        1e9 >
            1.01 * highest_rate_hz * static_cast<double>(reader.findings().median_interval_ns())) {
      return std::nullopt;
    }
    if (row.findings.has(recording::Finding::rate_lost)) continue;
    for (std::size_t axis = 0; axis < rest.axes.size(); ++axis) {
      rest.axes[axis].push_back(kDegPerRad * static_cast<double>(row.rate_rad_s[axis]));
    }
  }
  rest.sample_period_s = static_cast<double>(reader.findings().median_interval_ns()) * 1e-9;
  return rest;
}

/// Root of a variance, with its standard error.
Figure root(const identify::Estimate& variance) {
  const double value = std::sqrt(variance.value);
  return {value, variance.standard_error / (2.0 * value)};
}

/// Recordings of about one rate belong together: those within 5 % of each other.
long rate_key(double sample_period_s) {
  return std::lround(std::log(sample_period_s) / std::log(1.05));
}

/// One axis of one recording, and the noise found on another.
struct Piece {
  const RestRecording* recording;
  std::size_t axis;
  FittedNoise noise;
  Scores scores;
  std::vector<std::string> names;
};

void run_piece(Piece& piece, const MeasuredOptions& options) {
  const std::vector<double>& samples = piece.recording->axes[piece.axis];
  const Predictors predictors = measured_predictors(piece.noise, options);
  for (const auto& predictor : predictors) piece.names.push_back(predictor->name());
  const auto length = static_cast<Index>(options.lengths.total());
  const auto sets = samples.size() / options.lengths.total();
  const auto cut = [&](std::size_t first, MatrixXd& block) {
    block = Eigen::Map<const MatrixXd>(samples.data() + first * options.lengths.total(), length,
                                       block.cols());
  };
  piece.scores = run_contest(predictors, options.lengths, sets, cut, 1, {});
  for (auto& scores : piece.scores) {
    for (Score& score : scores) score.integrated_error *= piece.recording->sample_period_s;
  }
}

MeasuredTable collect(const std::vector<Piece*>& pieces) {
  MeasuredTable table{.sample_period_s = pieces.front()->recording->sample_period_s};
  Scores all;
  const std::vector<std::string>* names = nullptr;
  for (const Piece* piece : pieces) {
    table.fits.push_back(piece->noise);
    if (piece->scores.empty()) continue;
    names = &piece->names;
    all.resize(piece->scores.size());
    table.sets += piece->scores.front().size();
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].insert(all[i].end(), piece->scores[i].begin(), piece->scores[i].end());
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    table.standings.push_back(make_standing((*names)[i], all[i], all.back()));
  }
  return table;
}

void require_enough(const std::vector<const RestRecording*>& group, const Lengths& lengths) {
  if (group.size() < 2) {
    throw std::invalid_argument(group.front()->name +
                                ": the noise is to be fitted on another recording of the same "
                                "rate, and there is none; give a second one");
  }
  for (const RestRecording* recording : group) {
    if (recording->axes.front().size() < 2 * lengths.total()) {
      throw recording::DataError(recording->name + ": shorter than two sets of " +
                                 std::to_string(lengths.total()) + " samples");
    }
  }
}

}  // namespace

std::vector<RestRecording> read_rest_recordings(const std::vector<fs::path>& paths,
                                                double highest_rate_hz) {
  std::vector<RestRecording> recordings;
  for (const fs::path& file : recording_files(paths)) {
    if (auto recording = read_rest_recording(file, highest_rate_hz)) {
      recordings.push_back(std::move(*recording));
    }
  }
  if (recordings.empty()) throw recording::DataError("no recording in the data is slow enough");
  return recordings;
}

FittedNoise fit_noise(const RestRecording& recording, std::size_t axis) {
  const std::vector<double>& rate = recording.axes[axis];
  const auto half = identify::fit_white_flicker(rate, {.order = 0.5});
  const auto free = identify::fit_white_flicker(rate);
  FittedNoise fit{.recording = recording.name,
                  .axis = axis,
                  .sample_period_s = recording.sample_period_s,
                  .white = root(half.white_variance)};
  if (!half.flicker || !free.flicker) return fit;
  fit.flicker = root(half.flicker->innovation_variance);
  fit.order = {free.flicker->order.value, free.flicker->order.standard_error};
  fit.half_order = {.order = 0.5,
                    .innovation_variance = half.flicker->innovation_variance.value,
                    .white_variance = half.white_variance.value};
  // The lags of the node's filter stand for orders below 1.
  fit.free_order = {.order = std::min(fit.order.value, 0.95),
                    .innovation_variance = free.flicker->innovation_variance.value,
                    .white_variance = free.white_variance.value};
  return fit;
}

Predictors measured_predictors(const FittedNoise& fit, const MeasuredOptions& options) {
  const Lengths& lengths = options.lengths;
  const DecadeNoise half{.noise = fit.half_order,
                         .sample_period_s = fit.sample_period_s,
                         .decades = options.decades,
                         .start = core::Start::stationary};
  DecadeNoise free = half;
  free.noise = fit.free_order;
  Predictors predictors;
  predictors.push_back(make_full_state("full-state Kalman (paper)", fit.half_order, lengths));
  predictors.push_back(
      make_optimum("optimum for zero start", fit.half_order, reference::Bias::diffuse, lengths));
  predictors.push_back(make_decade_kalman("decade Kalman, d = 1/2", half, lengths));
  predictors.push_back(make_decade_kalman("decade Kalman, d fitted", free, lengths));
  predictors.push_back(make_autoregression("AR(4), least squares", AutoregressionFit::least_squares,
                                           4, fit.half_order, lengths));
  predictors.push_back(
      make_autoregression("AR(120), Burg", AutoregressionFit::burg, 120, fit.half_order, lengths));
  predictors.push_back(make_moving_average("moving average", half, lengths));
  predictors.push_back(make_calibration_mean("calibration mean", half, lengths));
  return predictors;
}

std::vector<MeasuredTable> measure_table1(const std::vector<RestRecording>& recordings,
                                          const MeasuredOptions& options,
                                          const parallel::Progress& progress) {
  std::map<long, std::vector<const RestRecording*>> rates;
  for (const RestRecording& recording : recordings) {
    rates[rate_key(recording.sample_period_s)].push_back(&recording);
  }
  std::vector<Piece> pieces;
  for (const auto& [key, group] : rates) {
    require_enough(group, options.lengths);
    for (std::size_t i = 0; i < group.size(); ++i) {
      const RestRecording& other = *group[(i + 1) % group.size()];
      const std::size_t axes = std::min(group[i]->axes.size(), other.axes.size());
      for (std::size_t axis = 0; axis < axes; ++axis) {
        pieces.push_back({group[i], axis, fit_noise(other, axis), {}, {}});
      }
    }
  }
  parallel::for_each(
      pieces.size(), options.threads,
      [&](std::size_t i) {
        if (pieces[i].noise.flicker.value > 0.0) run_piece(pieces[i], options);
      },
      progress);

  std::map<long, std::vector<Piece*>> of_rate;
  for (Piece& piece : pieces) of_rate[rate_key(piece.recording->sample_period_s)].push_back(&piece);
  std::vector<MeasuredTable> tables;
  tables.reserve(of_rate.size());
  for (const auto& [key, group] : of_rate) tables.push_back(collect(group));
  return tables;
}

}  // namespace zerorate::paper
