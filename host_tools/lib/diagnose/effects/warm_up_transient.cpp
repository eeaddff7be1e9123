#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_tools/lib/diagnose/effects/candidates.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using units::kDegPerRad;

constexpr double kShortest = 4.0;  // samples
constexpr double kLongest = 0.7;   // share of the record: a longer one is a ramp
constexpr double kFirstGrid = 1.5;

/// The exponential that dies out after switch-on. The part's shape: its time constant in s.
class WarmUpTransient final : public Effect {
 public:
  [[nodiscard]] std::string_view name() const override { return "warm_up_transient"; }
  [[nodiscard]] Pace pace() const override { return Pace::slow; }

  [[nodiscard]] Description describe(const FittedPart& fitted) const override {
    const double amplitude = fitted.amplitude(0) * kDegPerRad;
    const double time_constant = fitted.part().shape.front();
    const Column derivative = column_of(fitted.hypothesis.data(), [&](double time_s) {
      const double elapsed = time_s / time_constant;
      return fitted.amplitude(0) * elapsed * std::exp(-elapsed);
    });
    const double log_error = shape_error(fitted, derivative);
    return {
        .parameters = {parameter("amplitude_dps", amplitude,
                                 fitted.amplitude_error(0) * kDegPerRad),
                       positive_parameter("time_constant_s", time_constant, log_error)},
        .sentence = fmt::format("After the start the bias is off by {:.3g} deg/s, which dies out "
                                "with a time constant of {} s.",
                                amplitude, units::in_figures(time_constant)),
        .drawing = drawing_of(fitted)};
  }

  /// The next start may have another amplitude, so the interval is wider than that of this record.
  void add_to_model(const FittedPart& fitted, model::SensorModel& model) const override {
    const double amplitude = fitted.amplitude(0);
    model.warm_up = model::WarmUp{.amplitude_rad_s = amplitude,
                                  .amplitude_sigma_rad_s = std::hypot(
                                      fitted.amplitude_error(0), kShareOfNextStart * amplitude),
                                  .time_constant_s = fitted.part().shape.front()};
  }

 private:
  [[nodiscard]] std::optional<Candidate> find(const Hypothesis& without) const override {
    return timed_mean_candidate(
        without, [this](const ColumnSearch& scan) { return search(scan); }, kShortest,
        kLongest * static_cast<double>(without.data().size()));
  }

  [[nodiscard]] std::optional<Part> search(const ColumnSearch& scan) const {
    const FitData& data = scan.data();
    const double longest_s = kLongest * data.span_s();
    double best_s = 0.0;
    double best_gain = -1.0;
    const auto try_one = [&](double time_constant_s) {
      const double gain = scan.gain(decay_column(data, time_constant_s));
      if (gain <= best_gain) return;
      best_gain = gain;
      best_s = time_constant_s;
    };
    for (double s = longest_s; s > kShortest * data.period_s(); s /= kFirstGrid) try_one(s);
    for (double factor = std::sqrt(kFirstGrid); factor > 1.02; factor = std::sqrt(factor)) {
      const double centre = best_s;
      try_one(std::min(centre * factor, longest_s));
      try_one(centre / factor);
    }
    return Part{.effect = name(), .columns = {decay_column(data, best_s)}, .shape = {best_s}};
  }
};

}  // namespace

std::unique_ptr<Effect> make_warm_up_transient() {
  return std::make_unique<WarmUpTransient>();
}

}  // namespace zerorate::diagnose
