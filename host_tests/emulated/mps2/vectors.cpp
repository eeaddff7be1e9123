// The core's answers to the same questions on every processor: a checksum of their bits, section by
// section. Inputs come from integers, so that no C library has a say.

#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>

#include "core/base/crc32.hpp"
#include "core/base/numeric.hpp"
#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/kalman_predictor.hpp"
#include "core/estimator/moving_average.hpp"
#include "core/monitor/innovation_monitor.hpp"
#include "core/noise/hypotheses.hpp"
#include "core/noise/terms.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/wire/rate_frame.hpp"
#include "host_tests/emulated/mps2/print.hpp"

namespace {

using namespace zerorate;

constexpr auto kTick = core::Duration::milliseconds(100);

/// A checksum of the bits of numbers.
class Digest {
 public:
  void add(float x) { add(std::bit_cast<std::uint32_t>(x)); }
  void add(std::uint32_t x) {
    crc_ = core::crc32(std::bit_cast<std::array<std::uint8_t, 4>>(x), crc_);
  }
  void add(const core::Prediction& x) {
    add(x.bias_rad_s);
    add(x.variance_rad2_s2);
  }
  void add(const core::HeadingPrediction& x) {
    add(x.angle_rad);
    add(x.variance_rad2);
  }
  void add(const core::Innovation& x) {
    add(x.residual_rad_s);
    add(x.variance_rad2_s2);
    add(std::uint32_t{x.rejected});
  }
  [[nodiscard]] std::uint32_t value() const { return crc_; }

 private:
  std::uint32_t crc_ = 0;
};

/// Integers of 32 bits: xorshift (Marsaglia 2003).
class Integers {
 public:
  std::uint32_t next() {
    state_ ^= state_ << 13U;
    state_ ^= state_ >> 17U;
    state_ ^= state_ << 5U;
    return state_;
  }
  /// Between -1 and 1.
  float share() {
    return static_cast<float>(static_cast<std::int32_t>(next()) >> 7) / 16'777'216.0F;
  }

 private:
  std::uint32_t state_ = 2'463'534'242;
};

// Static and non-const: computed on the processor, not by the compiler.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables)
volatile float sigma_rad_s = 3e-5F;

auto noise_of_every_kind() {
  const float sigma = sigma_rad_s;
  core::FlickerDecades<4> flicker;
  flicker.time_constant_s = {0.1F, 1.0F, 10.0F, 100.0F};
  flicker.variance_rad2_s2.fill(sigma * sigma);
  return core::compose(
      kTick, core::Start::stationary, flicker,
      core::GaussMarkov{.sigma_rad_s = sigma, .time_constant_s = 3.0F},
      core::Harmonic{.rms_rad_s = sigma, .frequency_hz = 0.7F, .coherence_time_s = 20.0F},
      core::RandomWalk{.coefficient_rad_s_sqrt_s = 0.1F * sigma},
      core::WarmUp{.amplitude_rad_s = sigma, .sigma_rad_s = sigma, .time_constant_s = 60.0F},
      core::RateRamp{.slope_rad_s2 = sigma * 1e-6F, .sigma_rad_s2 = sigma * 1e-6F});
}
using Noise = decltype(noise_of_every_kind());
constexpr std::size_t kDecaying = std::tuple_size_v<decltype(Noise::decaying)>;
constexpr std::size_t kRotating = std::tuple_size_v<decltype(Noise::rotating)>;
constexpr core::ModelShape kShape{.decaying = kDecaying, .rotating = kRotating};

std::uint32_t numerics() {
  Digest digest;
  Integers integers;
  for (int i = 0; i < 3000; ++i) {
    const float x = std::bit_cast<float>(integers.next() & 0x7F7F'FFFFU);
    digest.add(core::square_root(x));
    digest.add(core::one_minus_exp_neg(core::is_finite(x) && x < 100.0F ? x : 1.0F));
    if (core::is_finite_positive(x)) digest.add(core::natural_log(x));
    const std::int64_t factor = integers.next();
    digest.add(core::to_float(factor * static_cast<std::int64_t>(integers.next() >> 1U)));
    digest.add(core::nearest_integer(integers.share() * 1e4F));
  }
  return digest.value();
}

template <class Value>
void add_spans(Digest& digest, const Value& spans) {
  for (const auto& span : spans) {
    const auto words = std::bit_cast<std::array<std::uint32_t, sizeof(span) / 4>>(span);
    for (const std::uint32_t word : words) digest.add(word);
  }
}
std::uint32_t spans() {
  Digest digest;
  const Noise noise = noise_of_every_kind();
  for (const std::uint32_t ticks : {0U, 1U, 2U, 7U, 1000U, 123'457U, 2'000'000'000U}) {
    const auto span = noise.over(ticks);
    add_spans(digest, span.decaying);
    add_spans(digest, span.rotating);
    digest.add(span.noise());
    digest.add(span.sum_variance());
  }
  return digest.value();
}

template <class Predictor, class Source>
std::uint32_t answers_of(const Source& source) {
  static Noise noise;
  noise = noise_of_every_kind();
  Predictor predictor{source};
  Digest digest;
  Integers integers;
  const auto one_tick = noise.one_tick();
  for (int stop = 0; stop < 4; ++stop) {
    predictor.begin_stop();
    const auto gap = noise.over(integers.next() % 5000U + 1U);
    for (int i = 0; i < 60; ++i) {
      const bool is_knock = i % 17 == 3;
      const float rate = 0.02F + integers.share() * (is_knock ? 0.1F : 1e-4F);
      digest.add(predictor.step(i == 0 ? gap : one_tick, rate, 1e-8F));
      digest.add(predictor.bias_rad_s(one_tick));
    }
    digest.add(predictor.predict(gap));
    digest.add(predictor.predict_heading(one_tick, gap));
  }
  return digest.value();
}

std::uint32_t kalman() {
  static core::KalmanCoefficients<kShape> coefficients{noise_of_every_kind()};
  return answers_of<core::KalmanPredictor<kShape>>(coefficients);
}
std::uint32_t gated_kalman() {
  static core::KalmanCoefficients<kShape> coefficients{
      noise_of_every_kind(), core::Gate{.threshold_sigma = 4.0F, .longest_knock_ticks = 5}};
  return answers_of<core::KalmanPredictor<kShape>>(coefficients);
}
std::uint32_t learning_kalman() {
  constexpr core::ModelShape kLearning = core::with_hypotheses(kShape, 3);
  static core::Hypotheses<kLearning> hypotheses;
  hypotheses = {.count = 3, .kept = 0.99F};
  Integers integers;
  for (auto& one : hypotheses.all) {
    for (float& strength : one.strength) strength = 1.0F + 0.9F * integers.share();
    one.log_prior = integers.share();
  }
  static core::KalmanCoefficients<kLearning> coefficients{
      noise_of_every_kind(),
      core::Gate{.threshold_sigma = 4.0F, .longest_knock_ticks = 5},
      {},
      hypotheses};
  return answers_of<core::KalmanPredictor<kLearning>>(coefficients);
}
std::uint32_t moving_average() {
  static const Noise noise = noise_of_every_kind();
  return answers_of<core::MovingAverage<kShape, 8>>(noise);
}
std::uint32_t calibration_mean() {
  static const Noise noise = noise_of_every_kind();
  return answers_of<core::CalibrationMean<kShape>>(noise);
}

/// The frames of a node over stops and drives, at 104 Hz.
std::uint32_t node_frames() {
  using Node = app::GyroNode<core::ModelShape{.decaying = 4},
                             app::NodeCapacity{.held_ticks = 8, .average_levels = 8}>;
  const float sigma = sigma_rad_s;
  static Node::Params params;
  params = {.model = {.white_variance_rad2_s2 = 2.4e-7F,
                      .sample_period = core::Duration::nanoseconds(9'615'385)},
            .standstill = {.hold_back = core::Duration::milliseconds(200)}};
  core::FlickerDecades<4> flicker;
  flicker.time_constant_s = {0.1F, 1.0F, 10.0F, 100.0F};
  flicker.variance_rad2_s2.fill(sigma * sigma);
  params.model.modes = core::compose(kTick, core::Start::stationary, flicker);
  Node node{params};
  Digest digest;
  Integers integers;
  core::Instant at = core::Instant::from_ns(1'000'000'000);
  for (std::uint32_t i = 0; i < 3000; ++i) {
    at = at + params.model.sample_period;
    const bool drives = i % 1500 > 1000;
    if (drives && i % 7 == 0) node.pulse(at);
    core::GyroSample sample{.time = at};
    for (auto& rate : sample.rate) {
      rate = core::rad_per_s(0.01F + integers.share() * (drives ? 0.3F : 1e-3F));
    }
    const wire::RateFrame frame = wire::encode_rate_frame({i, node.step(sample)});
    for (const std::uint8_t byte : frame.bytes()) {
      digest.add(std::uint32_t{byte});
    }
  }
  return digest.value();
}

}  // namespace

int main() {
  emulated::write_line("numerics", numerics());
  emulated::write_line("spans", spans());
  emulated::write_line("kalman", kalman());
  emulated::write_line("gated_kalman", gated_kalman());
  emulated::write_line("learning_kalman", learning_kalman());
  emulated::write_line("moving_average", moving_average());
  emulated::write_line("calibration_mean", calibration_mean());
  emulated::write_line("node_frames", node_frames());
  return 0;
}
