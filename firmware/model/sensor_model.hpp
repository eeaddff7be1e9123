/// @file
/// Noise of one gyro axis: physical, and independent of any sampling rate.
///
/// A SensorModel is what a data sheet or an identification gives. The filter's coefficients are
/// derived from it and a sampling rate; nothing here knows about samples. Units are SI throughout;
/// spectra are two-sided. docs/reference/model-format.md describes the file it is kept in.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/noise/modes.hpp"

namespace zerorate::model {

/// Angle random walk: white rate noise, S(nu) = N^2.
struct WhiteNoise {
  /// N in rad/s/sqrt(Hz). Averaging over T seconds leaves the variance N^2 / T.
  double angle_random_walk_rad_per_sqrt_s = 0.0;
  std::string source{};  ///< where the figures come from, for humans

  bool operator==(const WhiteNoise&) const = default;
};

/// Bias instability: 1/f noise and its neighbours, S(nu) = B^2 (2 pi nu)^(-2d), with 2 pi nu in
/// rad/s.
///
/// The filter approximates it by first-order lags, one a decade of time constants (Keshner; the
/// paper's section IV-A), so its band is finite: `decades` and `shortest_time_constant_s` say
/// which.
struct Flicker {
  /// B in rad/s: the spectrum's square root at 2 pi nu = 1 rad/s, whatever the order. For d = 1/2
  /// it is the coefficient of IEEE Std 952, and the Allan deviation's floor is
  /// sqrt(2 ln 2 / pi) B = 0.664 B.
  double bias_instability_rad_s = 0.0;
  /// d in (0, 1). 1/2 is 1/f noise; larger wanders farther (1 would be a random walk).
  double order = 0.5;
  /// How many lags, 1 to 8. More reach longer horizons: the slowest lag has the time constant
  /// shortest_time_constant_s 10^(decades - 1).
  int decades = 6;
  /// Smaller models quicker flicker, which drowns in the white noise first.
  double shortest_time_constant_s = 0.5;
  std::string source{};

  bool operator==(const Flicker&) const = default;
};

/// Rate random walk: S(nu) = K^2 / (2 pi nu)^2.
struct RateRandomWalk {
  double coefficient_rad_s_per_sqrt_s = 0.0;  ///< K; the variance grows by K^2 a second
  std::string source{};

  bool operator==(const RateRandomWalk&) const = default;
};

/// Exponentially correlated noise (a first-order Gauss-Markov process), at its steady state.
struct GaussMarkov {
  double sigma_rad_s = 0.0;
  double time_constant_s = 0.0;
  std::string source{};

  bool operator==(const GaussMarkov&) const = default;
};

/// A line: vibration or a beat, whose phase and amplitude wander over `coherence_time_s`.
struct Harmonic {
  double rms_rad_s = 0.0;
  double frequency_hz = 0.0;
  double coherence_time_s = 0.0;
  std::string source{};

  bool operator==(const Harmonic&) const = default;
};

/// The share of the bias that follows the temperature T:
/// slope (T - reference) + curvature (T - reference)^2, both constant but known only roughly.
struct TemperatureDrift {
  double reference_degc = 0.0;
  double slope_rad_s_per_k = 0.0;  ///< expected; the node learns the sensor's own
  double slope_sigma_rad_s_per_k = 0.0;
  double curvature_rad_s_per_k2 = 0.0;
  double curvature_sigma_rad_s_per_k2 = 0.0;
  /// How far the sensing element lags behind the thermometer (first order); 0: not at all.
  double lag_s = 0.0;
  std::string source{};

  bool operator==(const TemperatureDrift&) const = default;
};

/// Quantity that a share of the bias is proportional to, beside the temperature. The unit of an
/// acceleration is g (specific force, 1 g upwards at rest), of a vibration g^2 (variance within a
/// tick, summed over the axes), of the temperature's rate of change K/s.
enum class InputQuantity : std::uint8_t {
  acceleration,  ///< all three axes, with coefficients that are not known
  acceleration_x,
  acceleration_y,
  acceleration_z,
  vibration,
  temperature_rate
};

/// Treatment of an acceleration or a vibration by a node that reads no accelerometer.
enum class WithoutAccelerometer : std::uint8_t {
  flag,   ///< the share of the bias is missed, and flagged
  ignore  ///< the model has no such share: for the model of a chip, with or without its
          ///< accelerometer
};

/// A share of the bias that follows a measured quantity, by coefficients that are constants of the
/// sensor.
struct Input {
  InputQuantity quantity = InputQuantity::acceleration;
  WithoutAccelerometer without_accelerometer = WithoutAccelerometer::flag;
  double sigma_rad_s_per_unit = 0.0;                   ///< standard deviation of a coefficient
  std::array<double, 3> coefficient_rad_s_per_unit{};  ///< expected on x, y and z
  std::string source{};

  bool operator==(const Input&) const = default;
};

/// A transient that decays from the first sample on: amplitude exp(-t / time_constant).
struct WarmUp {
  double amplitude_rad_s = 0.0;  ///< expected; the node learns the one of this start
  double amplitude_sigma_rad_s = 0.0;
  double time_constant_s = 0.0;
  std::string source{};

  bool operator==(const WarmUp&) const = default;
};

/// A bias that moves steadily from the first sample on.
struct RateRamp {
  double slope_rad_s2 = 0.0;  ///< expected; the node learns the one of this start
  double slope_sigma_rad_s2 = 0.0;
  std::string source{};

  bool operator==(const RateRamp&) const = default;
};

/// How a chip or a library makes whole steps of a rate.
enum class QuantizationMethod : std::uint8_t {
  rounding,   ///< nearest step
  truncation  ///< step toward zero, which a node undoes
};

/// Samples come in steps: noise of the variance step^2 / 12, which averaging removes only where
/// other noise moves the rate from step to step.
struct Quantization {
  double step_rad_s = 0.0;
  QuantizationMethod method = QuantizationMethod::rounding;
  std::string source{};

  bool operator==(const Quantization&) const = default;
};

/// Single wild samples: noise of their own on top, one sample at a time.
struct Outliers {
  double probability = 0.0;  ///< probability that a sample is one
  double sigma_rad_s = 0.0;
  std::string source{};

  bool operator==(const Outliers&) const = default;
};

/// Rotations inside what is held for a standstill.
struct MotionContamination {
  double interval_s = 0.0;  ///< mean time from the end of one to the beginning of the next
  double duration_s = 0.0;  ///< mean
  double sigma_rad_s = 0.0;
  std::string source{};

  bool operator==(const MotionContamination&) const = default;
};

/// White noise whose strength wanders.
struct VariableNoise {
  double variance_sigma = 0.0;   ///< standard deviation of its variance, over the mean variance
  double time_constant_s = 0.0;  ///< after which that is forgotten
  std::string source{};

  bool operator==(const VariableNoise&) const = default;
};

/// Ends of the measuring range: a rate beyond reads as the end.
struct Saturation {
  double lower_rad_s = 0.0;
  double upper_rad_s = 0.0;
  std::string source{};

  bool operator==(const Saturation&) const = default;
};

/// Rule for a measurement that is too far from its prediction.
struct Gate {
  double threshold_sigma = 0.0;  ///< larger: fewer rejections, more harm by what passes
  /// Disagreement that lasts longer is a change of the bias, not a knock, and is learnt.
  double longest_knock_s = 5.0;
  std::string source{};

  bool operator==(const Gate&) const = default;
};

/// Change of the bias from one switching-on to the next, beside what the noise did meanwhile.
struct TurnOn {
  double sigma_rad_s = 0.0;
  std::string source{};

  bool operator==(const TurnOn&) const = default;
};

/// Zero-rate level of the chip by its specification.
struct ZeroRate {
  double limit_rad_s = 0.0;  ///< a bias beyond, either way, is flagged
  std::string source{};

  bool operator==(const ZeroRate&) const = default;
};

/// Error of the scale factor, which rest does not show: a turn by 100 deg is measured as 101 deg.
struct ScaleFactor {
  double sigma = 0.01;           ///< relative standard deviation over the parts of a kind
  double asymmetry_sigma = 0.0;  ///< half the difference between both senses of rotation
  double sigma_per_k = 1e-4;     ///< relative change a kelvin, standard deviation over the parts
  double reference_degc = 25.0;  ///< temperature at which `sigma` holds
  /// Known errors of x, y and z, relative, which a node takes off; `sigma` is about what is left.
  std::array<double, 3> error{};
  std::string source{};

  bool operator==(const ScaleFactor&) const = default;
};

/// Mounting of the sensor in the vehicle.
struct Mounting {
  /// Standard deviation of the angle between the axis and the vertical; of a turn about the
  /// vertical the axis measures the cosine.
  double tilt_sigma_rad = 0.0;
  /// Standard deviation of the slope of the road, along and across; a tilted axis takes a change of
  /// it for a turn.
  double slope_sigma = 0.04;
  std::string source{};

  bool operator==(const Mounting&) const = default;
};

/// How a node learns the slow noise of its sensor, from the figures of the model.
struct Learning {
  int hypotheses = 12;         ///< 12, 4 (of one order) or 1: the model is taken at its word
  double half_life_s = 150.0;  ///< half-life of the evidence, in time at standstill

  bool operator==(const Learning&) const = default;
};

/// Knowledge of a sensor like this one beside its data sheet: how far from the model's its
/// flicker may be, from a population of sensors.
struct Prior {
  double order = 0.62;  ///< d: mean over sensors
  double order_sigma = 0.12;
  double amplitude_factor = 5.5;  ///< one standard deviation of B / N, as a factor
  std::string source{};

  bool operator==(const Prior&) const = default;
};

/// Settings of the node besides the noise.
struct Node {
  core::Start start = core::Start::stationary;

  bool operator==(const Node&) const = default;
};

/// The noise model of one gyro axis. The constant part of the bias is not in it: nothing is known
/// about it before the first standstill.
struct SensorModel {
  std::string name{};
  WhiteNoise white;
  std::optional<Flicker> flicker;
  std::optional<RateRandomWalk> rate_random_walk;
  std::vector<GaussMarkov> gauss_markov;
  std::vector<Harmonic> harmonic;
  std::optional<TemperatureDrift> temperature;
  std::vector<Input> inputs{};
  std::optional<WarmUp> warm_up;
  std::optional<RateRamp> rate_ramp;
  std::optional<Quantization> quantization;
  std::optional<Outliers> outliers;
  std::optional<MotionContamination> motion_contamination;
  std::optional<VariableNoise> variable_noise;
  std::optional<Saturation> saturation;
  std::optional<Gate> gate;
  std::optional<TurnOn> turn_on;
  std::optional<ZeroRate> zero_rate{};
  std::optional<ScaleFactor> scale_factor{};  ///< absent: the default tolerance
  std::optional<Mounting> mounting{};         ///< absent: the axis is vertical
  std::optional<Learning> learning;           ///< absent: the defaults
  std::optional<Prior> prior;
  Node node;

  bool operator==(const SensorModel&) const = default;
};

/// Throws std::invalid_argument, which names the field and what was expected, where a number is
/// impossible: negative, not finite, an order outside (0, 1), ...
void validate(const SensorModel& model);
void validate(const Flicker& flicker);

}  // namespace zerorate::model
