#include "host_tools/lib/diagnose/record/input_ticks.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/units.hpp"
#include "host_tools/lib/identify/characterize.hpp"

namespace zerorate::diagnose {
namespace {

/// Samples of a tick below which its variance says little of the vibration.
constexpr std::size_t kFewestForVibration = 8;

bool is_whole(const std::array<float, 3>& acceleration) {
  return std::ranges::all_of(acceleration, [](float along) { return std::isfinite(along); });
}

/// Mean and variance of the accelerations of a tick.
class TickOfInputs {
 public:
  void add(const std::array<float, 3>& acceleration_m_s2) {
    if (!is_whole(acceleration_m_s2)) return;
    ++count_;
    for (std::size_t i = 0; i < 3; ++i) {
      const double g = double{acceleration_m_s2[i]} / double{core::kStandardGravity_m_s2};
      const double step = g - mean_g_[i];
      mean_g_[i] += step / static_cast<double>(count_);
      squares_g2_ += step * (g - mean_g_[i]);
    }
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] const std::array<double, 3>& mean_g() const { return mean_g_; }
  [[nodiscard]] double variance_g2() const {
    return count_ > 1 ? squares_g2_ / static_cast<double>(count_ - 1) : 0.0;
  }

 private:
  std::size_t count_ = 0;
  std::array<double, 3> mean_g_{};
  double squares_g2_ = 0.0;
};

/// Mean of the temperatures from `first` up to `end`, those that were lost left out; NaN without
/// any.
double mean_temperature(const std::vector<float>& degc, std::size_t first, std::size_t end) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t k = first; k < end; ++k) {
    if (!std::isfinite(degc[k])) continue;
    sum += double{degc[k]};
    count += 1.0;
  }
  return sum / count;
}

}  // namespace

InputTicks input_ticks_of(const identify::RestSamples& samples) {
  InputTicks ticks;
  if (samples.acceleration_m_s2.empty()) return ticks;
  ticks.tick = identify::identification_tick(samples);
  ticks.sample_period = samples.mean_period;
  const bool shows_vibration =
      ticks.tick >= samples.mean_period * static_cast<std::int64_t>(kFewestForVibration);
  const std::size_t fewest = shows_vibration ? kFewestForVibration : 1;
  std::size_t first = 0;
  for (const identify::TickMean& mean : identify::average_ticks(samples, ticks.tick)) {
    const std::size_t end = first + mean.samples;
    TickOfInputs inputs;
    for (std::size_t k = first; k < end; ++k) inputs.add(samples.acceleration_m_s2[k]);
    if (inputs.count() >= fewest) {
      const auto next = std::ranges::upper_bound(samples.after_drives, first);
      ticks.means.push_back(mean);
      ticks.acceleration_g.push_back(inputs.mean_g());
      ticks.standstill.push_back(static_cast<std::size_t>(next - samples.after_drives.begin()));
      if (shows_vibration) ticks.vibration_g2.push_back(inputs.variance_g2());
      if (!samples.temperature_degc.empty()) {
        ticks.temperature_degc.push_back(mean_temperature(samples.temperature_degc, first, end));
      }
    }
    first = end;
  }
  const bool is_lossy =
      std::ranges::any_of(ticks.temperature_degc, [](double degc) { return !std::isfinite(degc); });
  if (is_lossy) ticks.temperature_degc.clear();
  return ticks;
}

InputTicks beginning_of(const InputTicks& ticks, std::size_t size) {
  InputTicks beginning = ticks;
  const auto cut = [&](auto& values) { values.resize(std::min(size, values.size())); };
  cut(beginning.means);
  cut(beginning.acceleration_g);
  cut(beginning.vibration_g2);
  cut(beginning.temperature_degc);
  cut(beginning.standstill);
  return beginning;
}

std::vector<double> means_by_standstill(const InputTicks& ticks,
                                        const std::vector<double>& values) {
  std::vector<double> means;
  for (std::size_t first = 0; first < ticks.size();) {
    std::size_t end = first;
    double sum = 0.0;
    for (; end < ticks.size() && ticks.standstill[end] == ticks.standstill[first]; ++end) {
      sum += values[end];
    }
    means.push_back(sum / static_cast<double>(end - first));
    first = end;
  }
  return means;
}

}  // namespace zerorate::diagnose
