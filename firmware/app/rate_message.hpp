/// @file
/// Message that the node publishes for every sample of the gyro, and while there are none.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/earth_rate.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "core/standstill/calm_share.hpp"
#include "core/standstill/standstill.hpp"

namespace zerorate::app {

/// The state of the node and of this sample. Every flag is an alarm except `calibrated`.
struct Health {
  bool calibrated = false;          ///< a bias was measured, and borne out for a second after it
  bool sample_refused = false;      ///< no rate: not finite, or beyond 1e6 rad/s
  bool time_refused = false;        ///< not after the sample before: no rate in this message
  bool saturated = false;           ///< an axis at full scale: the rate is a lower bound
  bool model_inconsistent = false;  ///< innovations larger or smaller than the model allows
  bool odometer_fault =
      false;                  ///< the odometer input failed or dropped edges since the last message
  bool sensor_fault = false;  ///< the gyro gives no samples: no rate in this message
  /// One axis took the newest measurement for a knock: learnt from on no axis, but doubted, which
  /// widens the interval until a measurement agrees or the bias is learnt anew (see core::Gate).
  bool measurement_rejected = false;
  /// The model follows the temperature, and there is none: the interval is wider.
  bool temperature_missing = false;
  /// The model follows the acceleration, and there is none: the interval is wider.
  bool acceleration_missing = false;
  /// Gyro and odometer cannot both be right (see core::OdometerCheck): a turn without pulses, from
  /// which nothing is learnt; pulses without any motion; pulses that follow too closely.
  bool odometer_disagreement = false;
  /// The gyro found motion inside most of the newest stops: the odometer is silent while the
  /// vehicle still rolls (see core::CalmJudge). Nothing is learnt from that motion.
  bool odometer_dead_band = false;
  /// Samples come at another rate than the nominal one, by a quarter and more (see RateWatch): some
  /// are lost, or the chip is set otherwise. Rates are right; motion between samples is missed.
  bool sample_rate_off = false;
  /// References of the heading and the gyro cannot both be right (see core::HeadingFilter).
  bool reference_disagreement = false;

  /// Whether the rate may be used with its interval: calibrated, and nothing puts either in doubt.
  /// The other flags keep from learning, or widen the interval.
  [[nodiscard]] constexpr bool is_usable() const {
    return calibrated && !sample_refused && !time_refused && !saturated && !model_inconsistent &&
           !sensor_fault && !measurement_rejected && !odometer_disagreement &&
           !reference_disagreement;
  }
  constexpr bool operator==(const Health&) const = default;
};

struct AxisRate {
  core::AngularRate measured;  ///< rate of the chip
  /// Measured without the known error of the scale factor, less the bias, over the scale factor
  /// where that was learnt.
  core::AngularRate corrected;
  core::AngularRate bias;
  core::AngularRate sigma;  ///< standard deviation of the bias; infinite until measured

  constexpr bool operator==(const AxisRate&) const = default;
};

/// Angle that an axis has turned by since departure (see core::TurnSum).
struct AxisTurn {
  core::Angle angle;
  /// Standard deviation of its error; infinite where no departure is known, and after full scale.
  core::Angle sigma = core::rad(std::numeric_limits<float>::infinity());

  constexpr bool operator==(const AxisTurn&) const = default;
};

/// Heading of the vehicle by its references and its gyro, counter-clockwise seen from above.
struct Heading {
  core::Angle angle;
  /// Standard deviation of its error; infinite before a reference, and where the turn was lost.
  core::Angle sigma = core::rad(std::numeric_limits<float>::infinity());

  constexpr bool operator==(const Heading&) const = default;
};

/// Shares of the bias of an axis that follow its inputs: each coefficient, as it was learnt, times
/// its input now. They are zero at the reference temperature, without any force, and without
/// vibration.
struct ExplainedBias {
  core::AngularRate temperature;   ///< with its square and its rate of change
  core::AngularRate acceleration;  ///< forces along the three axes together
  core::AngularRate vibration;

  constexpr bool operator==(const ExplainedBias&) const = default;
};

struct RateMessage {
  static constexpr std::uint8_t kNoCalm = core::CalmShare::kNoPercent;

  core::Instant time;
  core::Motion motion = core::Motion::moving;
  Health health;
  /// Share of the newest stop that was calm enough to learn from; kNoCalm before anything was
  /// judged.
  std::uint8_t calm_percent = kNoCalm;
  std::array<AxisRate, 3> axes{};  ///< x, y, z of the sensor
  std::array<AxisTurn, 3> turn{};  ///< x, y, z, since departure
  core::Duration turn_time;        ///< time that was summed since departure
  AxisTurn vertical_turn;          ///< likewise about the vertical, counter-clockwise from above
  Heading heading;
  std::optional<core::Direction> up;  ///< in the axes of the sensor, where it is known
  /// Angle between the vertical and its mean over the stops before: the slope of a parking place,
  /// or of the road. From the second stop on, where the vertical is measured.
  std::optional<core::Angle> slope;
  std::optional<core::Temperature>
      temperature;  ///< temperature of the sensor, where the chip gave one
  /// Odometer pulses since the start of the loop, lost ones included, modulo 2^32; none without an
  /// odometer.
  std::optional<std::uint32_t> odometer_pulses;
  /// Specific force along x, y, z of the chip, where the sample had it.
  std::optional<std::array<core::Acceleration, 3>> acceleration;
  /// Root mean square of its changes within the newest tick, over the three axes together.
  std::optional<core::Acceleration> vibration;
  /// Shares of the bias of x, y, z that follow the inputs, where the model has inputs.
  std::optional<std::array<ExplainedBias, 3>> explained;

  [[nodiscard]] constexpr bool has_rate() const {
    return !health.sample_refused && !health.time_refused && !health.sensor_fault;
  }
  /// Corrected rate about the vertical, counter-clockwise seen from above. Needs `up`.
  [[nodiscard]] constexpr core::AngularRate vertical_rate() const {
    core::AngularRate rate;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      if ((*up)[i] != 0.0F) rate = rate + (*up)[i] * axes[i].corrected;
    }
    return rate;
  }
  constexpr bool operator==(const RateMessage&) const = default;
};

/// Takes the node's messages. publish() must not block; a sink that is full drops and counts.
template <class S>
concept RateSink = requires(S sink, const RateMessage& message) {
  { sink.publish(message) } -> std::same_as<void>;
};

}  // namespace zerorate::app
