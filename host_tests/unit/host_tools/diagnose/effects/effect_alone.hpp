/// @file
/// An effect of the catalogue, alone beside white and flicker noise, on a record of 500 s.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "host_tests/support/simulated_rest.hpp"
#include "host_tools/lib/diagnose/effects/catalogue.hpp"
#include "host_tools/lib/diagnose/record/even_series.hpp"
#include "host_tools/lib/diagnose/record/record.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"
#include "host_tools/lib/simulate/simulate.hpp"

namespace zerorate::diagnose {

using zerorate::testing::kRadPerDeg;

inline constexpr std::size_t kSamples = 5'000;
inline constexpr double kPeriod_s = 0.1;

/// A record with 0.3 deg/s of bias, white noise of 0.126 deg/s a sample, flicker noise and `more`.
inline Record record_with(const std::vector<simulate::Effect>& more, std::uint64_t seed = 11) {
  std::vector<simulate::Effect> effects{simulate::ConstantBias{0.3 * kRadPerDeg},
                                        simulate::WhiteNoise{0.04 * kRadPerDeg},
                                        simulate::FlickerNoise{15.0 / 3600.0 * kRadPerDeg, 0.5}};
  effects.insert(effects.end(), more.begin(), more.end());
  return record_of(zerorate::testing::rest_samples_of(simulate::simulate(
                       simulate::Signal(kSamples, kPeriod_s), effects, random::RandomStream(seed))),
                   0);
}

/// A record whose samples come too unevenly for a grid.
inline EvenSeries series_of_ticks() {
  EvenSeries series = even_series_of(record_with({}));
  series.is_ticks = true;
  return series;
}

class EffectAlone {
 public:
  EffectAlone(std::unique_ptr<Effect> effect, EvenSeries series)
      : series_(std::move(series)), effect_(std::move(effect)) {
    candidate_ = effect_->examine(without_);
    if (!candidate_) return;
    with_.emplace(data_, std::vector{candidate_->part}, &without_);
    description_ = effect_->describe({*with_, 0});
  }
  EffectAlone(std::unique_ptr<Effect> effect, const Record& record)
      : EffectAlone(std::move(effect), even_series_of(record)) {}
  EffectAlone(const EffectAlone&) = delete;
  EffectAlone& operator=(const EffectAlone&) = delete;

  [[nodiscard]] bool is_found() const {
    return candidate_ && candidate_->surprisal_nats > kSelectionThreshold_nats;
  }
  [[nodiscard]] std::string_view obstacle() const { return effect_->obstacle(without_); }

  /// Expects a figure of the effect within three of its own standard errors, 1.96 of which reach to
  /// the end of its interval.
  void expect_within_three_sigma(std::string_view name, double truth) const {
    const auto at = std::ranges::find(description_.parameters, name, &Parameter::name);
    ASSERT_NE(at, description_.parameters.end()) << name;
    constexpr double kReach = 3.0 / 1.96;
    EXPECT_GE(truth, at->value - kReach * (at->value - at->lo)) << name << " " << at->value;
    EXPECT_LE(truth, at->value + kReach * (at->hi - at->value)) << name << " " << at->value;
    EXPECT_LT(at->lo, at->hi) << name;
  }

  /// Whether a figure of the effect has the truth in its 95 % interval.
  [[nodiscard]] bool is_inside(std::string_view name, double truth) const {
    const auto at = std::ranges::find(description_.parameters, name, &Parameter::name);
    return at != description_.parameters.end() && at->lo <= truth && truth <= at->hi;
  }

  [[nodiscard]] const std::string& sentence() const { return description_.sentence; }
  /// A figure of the effect; NaN where it has none of that name.
  [[nodiscard]] double value_of(std::string_view name) const {
    const auto at = std::ranges::find(description_.parameters, name, &Parameter::name);
    return at == description_.parameters.end() ? std::numeric_limits<double>::quiet_NaN()
                                               : at->value;
  }

  /// The node's model with nothing in it but the effect.
  [[nodiscard]] model::SensorModel model() const {
    model::SensorModel model;
    effect_->add_to_model({*with_, 0}, model);
    return model;
  }
  [[nodiscard]] const Description& description() const { return description_; }

 private:
  EvenSeries series_;
  FitData data_{series_, 1};
  Hypothesis without_{data_, {}};
  std::unique_ptr<Effect> effect_;
  std::optional<Candidate> candidate_;
  std::optional<Hypothesis> with_;
  Description description_;
};

}  // namespace zerorate::diagnose
