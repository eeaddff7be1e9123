#include "host_tools/python/evaluation.hpp"

#include <cstddef>
#include <cstdint>

#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/evaluate/replay_json.hpp"
#include "host_tools/lib/identify/rest_samples.hpp"
#include "host_tools/lib/truth/truth.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::python {
namespace {

constexpr auto kMean = static_cast<std::size_t>(app::Predictor::calibration_mean);

/// Collects the figures of one replay.
class Collector {
 public:
  explicit Collector(std::size_t axes) : axes_(axes) {}

  /// @param observer  has to outlive it only in its own part; gets the callbacks
  void watch(evaluate::ReplayObserver& observer) {
    observer.on_sample = [this, &observer](const evaluate::ReplayedSample& sample) {
      take(sample, observer.truth);
    };
    observer.on_stop = [this](const evaluate::ReplayedStop& stop) { take(stop); };
    observer.on_drive = [this](const evaluate::ReplayedDrive& drive) { take(drive); };
  }

  Details finish(const evaluate::ReplayResult& result) {
    if (result.true_drives) add_true_drives(*result.true_drives);
    return std::move(details_);
  }

 private:
  void add(const char* name, double figure) { details_[name].push_back(figure); }

  void take(const evaluate::ReplayedSample& sample, const std::optional<truth::Truth>& truth) {
    while (truth && departures_.size() < truth->drives.size() &&
           sample.time_ns >= truth->drives[departures_.size()].departure_ns) {
      departures_.push_back(
          {.period = periods_,
           .mean_rad_s = double{sample.last_stop_mean_rad_s[truth->vertical.axis]}});
    }
    const bool stands = sample.message.motion == core::Motion::still;
    if (stands && !stands_) ++periods_;
    stands_ = stands;
    if (motion_.moves(sample)) periods_before_drive_ = periods_;
    add("still", stands && sample.message.has_rate() ? 1.0 : 0.0);
  }

  void take(const evaluate::ReplayedStop& stop) {
    add("stop_period", periods_before_drive_ - 1.0);
    for (std::size_t i = 0; i < axes_; ++i) {
      add("stop_measured", stop.measured_rad_s[i]);
      for (const double error : stop.error_rad_s[i]) add("stop_error", error);
    }
  }

  void take(const evaluate::ReplayedDrive& drive) {
    if (drive.axis == 0 && drive.predictor == app::Predictor::kalman) {
      add("drive_period", periods_ - 1.0);
      add("drive_from_s", units::seconds(drive.start_ns));
      add("drive_length_s", drive.length_s);
    }
    if (drive.predictor == app::Predictor::kalman) add("drive_measured", drive.measured_rad);
    add("drive_error", drive.outcome.drift_rad);
  }

  void add_true_drives(const evaluate::TrueDrives& drives) {
    for (std::size_t k = 0; k < std::min(drives.drives.size(), departures_.size()); ++k) {
      const evaluate::ScoredTrueDrive& scored = drives.drives[k];
      if (scored.flaw != truth::Flaw::none) continue;
      const double length_s = units::seconds(scored.drive.to_ns - scored.drive.from_ns);
      const double sign = drives.truth.vertical.sign;
      add("true_period", departures_[k].period - 1.0);
      add("true_from_s", units::seconds(scored.drive.from_ns));
      add("true_length_s", sign * length_s);
      add("true_measured",
          scored.at_departure[kMean].drift_rad + sign * departures_[k].mean_rad_s * length_s);
      for (const evaluate::DriveOutcome& one : scored.at_departure)
        add("true_error", one.drift_rad);
    }
    add("true_axis", static_cast<double>(drives.truth.vertical.axis));
  }

  /// State at a departure.
  struct Departure {
    double period;
    double mean_rad_s;
  };

  std::size_t axes_;
  Details details_;
  double periods_ = 0.0;               ///< periods of rest that have begun
  double periods_before_drive_ = 0.0;  ///< those before the newest drive
  evaluate::MotionOfReplay motion_;
  bool stands_ = false;
  std::vector<Departure> departures_;
};

}  // namespace

std::pair<std::string, Details> evaluate_recording(const Source& source, const std::string& axis,
                                                   const std::optional<std::string>& schedule,
                                                   const NodeOptions& options,
                                                   const std::string& vertical_axis,
                                                   std::optional<double> reference_error_deg,
                                                   double reference_from_s) {
  recording::Reader reader = source.open();
  const std::size_t axis_count = reader.columns().axis_count;
  const auto axes = identify::axes_called(axis, axis_count);
  evaluate::ReplayOptions replay = to_replay_options(options);
  evaluate::ReplayObserver observer;
  if (schedule) {
    replay.schedule = evaluate::parse_schedule(*schedule);
  } else {
    truth::TruthOptions truth{.usable_from_s = reference_from_s};
    if (!vertical_axis.empty()) truth.vertical = truth::parse_vertical_axis(vertical_axis);
    if (reference_error_deg) truth.reference_error_rad = *reference_error_deg * units::kRadPerDeg;
    recording::Reader first = source.open();
    observer.truth = truth::read_truth(first, truth);
  }
  Collector collector{axis_count};
  collector.watch(observer);
  const evaluate::ReplayResult result = evaluate::replay(reader, replay, observer);
  return {evaluate::to_json(result, axes), collector.finish(result)};
}

}  // namespace zerorate::python
