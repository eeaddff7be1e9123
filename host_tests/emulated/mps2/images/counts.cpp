// How many instructions the node's pieces take: each between two readings of SysTick. The runner
// (emulated_processor.py) converts periods to instructions.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/base/time.hpp"
#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/kalman_bank.hpp"
#include "core/estimator/moving_average.hpp"
#include "core/noise/hypotheses.hpp"
#include "core/noise/terms.hpp"
#include "core/samples/tick_average.hpp"
#include "drivers/common/gyro_source.hpp"
#include "firmware/app/gyro_node.hpp"
#include "hal/cortex_m/timer.hpp"
#include "host_tests/emulated/mps2/print.hpp"

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): firmware's state is static
namespace {

using namespace zerorate;
using hal::cortex_m::SysTick;

constexpr auto kTick = core::Duration::milliseconds(100);
constexpr auto kSamplePeriod = core::Duration::nanoseconds(9'615'385);  // 104 Hz
constexpr std::size_t kDecades = 6;
constexpr core::ModelShape kShape{.decaying = kDecades};
constexpr float kWhiteVariance = 2.4e-7F;

// Inputs that the compiler cannot know, and results that it must not leave out.
volatile std::uint32_t unknown_ticks = 6000;
volatile float report;

constexpr auto kModes = core::compose(
    kTick, core::Start::stationary,
    core::FlickerDecades<kDecades>{.time_constant_s = {0.1F, 1.0F, 10.0F, 100.0F, 1e3F, 1e4F},
                                   .variance_rad2_s2 = {1e-9F, 1e-9F, 1e-9F, 1e-9F, 1e-9F, 1e-9F}});
constexpr core::KalmanCoefficients<kShape> kCoefficients{kModes};

std::uint32_t random_state = 1;
float noisy_rate_rad_s() {
  random_state = random_state * 1'664'525U + 1'013'904'223U;
  return 0.01F + static_cast<float>(static_cast<std::int32_t>(random_state) >> 8) * 1e-10F;
}

/// Periods that an action takes, beyond those of looking at the clock.
template <class Action>
[[gnu::noinline]] std::uint32_t periods_of(Action action) {
  const std::uint32_t start = SysTick::count();
  const std::uint32_t looking = SysTick::since(start);
  const std::uint32_t before = SysTick::count();
  action();
  const std::uint32_t periods = SysTick::since(before);
  return periods > looking ? periods - looking : 0;
}

/// The mean over many calls, in hundredths of a period.
/// @param prepare what is done before each of them, uncounted
template <class Prepare, class Action>
std::uint32_t mean_hundredths(std::uint32_t calls, Prepare prepare, Action action) {
  std::uint32_t sum = 0;
  for (std::uint32_t i = 0; i < calls; ++i) {
    prepare();
    sum += periods_of(action);
  }
  return static_cast<std::uint32_t>(std::uint64_t{sum} * 100 / calls);
}
template <class Action>
std::uint32_t mean_hundredths(std::uint32_t calls, Action action) {
  return mean_hundredths(
      calls, [] {}, action);
}

template <class Predictor>
void count_predictor(Predictor& predictor, const char* step, const char* gap, const char* predict) {
  const auto tick = kModes.one_tick();
  predictor.begin_stop();
  for (int i = 0; i < 50; ++i) (void)predictor.step(tick, noisy_rate_rad_s(), kWhiteVariance);
  float rate_rad_s = 0.0F;
  emulated::write_line(step, mean_hundredths(
                                 64, [&] { rate_rad_s = noisy_rate_rad_s(); },
                                 [&] { (void)predictor.step(tick, rate_rad_s, kWhiteVariance); }));
  const auto span = kModes.over(unknown_ticks);
  emulated::write_line(gap, mean_hundredths(4, [&] { predictor.advance(span); }));
  emulated::write_line(predict,
                       mean_hundredths(4, [&] { report = predictor.predict(span).sigma_rad_s(); }));
}

using Kalman = core::KalmanBank<kShape, 3>;
constinit Kalman kalman{kCoefficients};
constinit core::MovingAverage<kShape, 8> moving_average{kModes};
constinit core::CalibrationMean<kShape> calibration_mean{kModes};

/// Twelve hypotheses of the slow noise, of which each has half or twice the strength of its
/// neighbour.
constexpr core::ModelShape kLearningShape = core::with_hypotheses(kShape, 12);
constexpr auto kHypotheses = [] {
  core::Hypotheses<kLearningShape> hypotheses{.count = 12, .kept = 0.999F};
  float strength = 0.01F;
  for (auto& one : hypotheses.all) one.strength.fill(strength *= 2.0F);
  return hypotheses;
}();
constexpr core::KalmanCoefficients<kLearningShape> kLearningCoefficients{
    kModes, core::Gate{}, core::kNoInputs<kLearningShape>, kHypotheses};
constinit core::KalmanBank<kLearningShape, 3> bank{kLearningCoefficients};

/// A Kalman predictor of three axes.
void count_kalman(auto& predictor, const char* step_name, const char* gap_name,
                  const char* predict_name) {
  const auto tick = kModes.one_tick();
  std::array<float, 3> rates{};
  const auto measure = [&] {
    for (float& rate : rates) rate = noisy_rate_rad_s();
  };
  const auto step = [&] {
    predictor.advance(tick);
    (void)predictor.observe(rates, kWhiteVariance);
  };
  for (int i = 0; i < 50; ++i) {
    measure();
    step();
  }
  emulated::write_line(step_name, mean_hundredths(64, measure, step));
  const auto span = kModes.over(unknown_ticks);
  emulated::write_line(gap_name, mean_hundredths(4, [&] { predictor.advance(span); }));
  emulated::write_line(predict_name, mean_hundredths(4, [&] {
                         for (const auto& axis : predictor.predict(span))
                           report = axis.sigma_rad_s();
                       }));
}

void count_predictors() {
  count_kalman(kalman, "kalman_step", "kalman_gap", "kalman_predict");
  count_kalman(bank, "bank_step", "bank_gap", "bank_predict");
  count_predictor(moving_average, "moving_average_step", "moving_average_gap",
                  "moving_average_predict");
  count_predictor(calibration_mean, "calibration_mean_step", "calibration_mean_gap",
                  "calibration_mean_predict");
  static core::Transition<kDecades, 0> span;
  emulated::write_line("span_of_a_gap", mean_hundredths(4, [] {
                         span = kModes.over(unknown_ticks);
                         asm volatile("" ::"r"(&span) : "memory");
                       }));
}

constinit core::TickAverage<3> average{kTick, kSamplePeriod};
constinit Kalman filter{kCoefficients};

/// Samples at 104 Hz averaged into ticks at 10 Hz, and a predict and update of each axis a tick.
void filter_a_sample(const core::Transition<kDecades, 0>& tick, core::Instant at,
                     const std::array<float, 3>& rate) {
  if (average.is_empty() || average.is_over_at(at)) {
    if (!average.is_empty()) {
      const auto mean = average.close();
      filter.advance(tick);
      (void)filter.observe(mean.rate_rad_s, kWhiteVariance / static_cast<float>(mean.samples));
    }
    average.enter(at);
  }
  average.add(at, rate);
}

void count_front_end() {
  static const auto tick = kModes.one_tick();
  core::Instant at;
  std::array<float, 3> rate{};
  const auto prepare = [&] {
    at = at + kSamplePeriod;
    rate.fill(noisy_rate_rad_s());
  };
  const auto one = [&] { filter_a_sample(tick, at, rate); };
  (void)mean_hundredths(104, prepare, one);
  emulated::write_line("averaged_sample_of_three_axes", mean_hundredths(1040, prepare, one));
}

template <core::ModelShape Shape>
using NodeOf = app::GyroNode<Shape, app::NodeCapacity{.held_ticks = 16, .average_levels = 8}>;
using Node = NodeOf<kShape>;
constexpr core::ModelShape kForceShape{
    .decaying = kShape.decaying, .inputs = 3, .has_accelerometer = true};
using ForceNode = NodeOf<kForceShape>;

constexpr Node::Params kParams{.model = {.modes = kModes,
                                         .white_variance_rad2_s2 = kWhiteVariance,
                                         .sample_period = kSamplePeriod},
                               .standstill = {.hold_back = core::Duration::milliseconds(500)}};
constexpr float kSensitivity_rad_s_g = 1e-3F;
constexpr ForceNode::Params kForceParams{
    .model = {.modes = kModes,
              .white_variance_rad2_s2 = kWhiteVariance,
              .inputs = {.terms = {{{core::Input::acceleration_x, kSensitivity_rad_s_g},
                                    {core::Input::acceleration_y, kSensitivity_rad_s_g},
                                    {core::Input::acceleration_z, kSensitivity_rad_s_g}}}},
              .sample_period = kSamplePeriod},
    .standstill = {.hold_back = core::Duration::milliseconds(500)}};
/// One node after the other: the memory holds no two.
union OneNode {
  constexpr OneNode() : plain(kParams) {}
  Node plain;
  ForceNode with_forces;
};
constinit OneNode node;

/// @param has_force whether the samples have an acceleration
void count_node(auto& of, bool has_force, const char* still, const char* moving) {
  core::GyroSample sample{.time = core::Instant::from_ns(1'000'000'000)};
  sample.has_acceleration = has_force;
  const auto prepare = [&] {
    sample.time = sample.time + kSamplePeriod;
    for (auto& rate : sample.rate) rate = core::rad_per_s(noisy_rate_rad_s());
    for (auto& force : sample.acceleration) force = core::m_per_s2(noisy_rate_rad_s());
    sample.acceleration[2] = core::m_per_s2(core::kStandardGravity_m_s2);
  };
  const auto one = [&] {
    const app::RateMessage message = of.step(sample);
    asm volatile("" ::"r"(&message) : "memory");  // all of it is used
  };
  (void)mean_hundredths(520, prepare, one);
  emulated::write_line(still, mean_hundredths(1040, prepare, one));
  of.pulse(sample.time);
  emulated::write_line(moving, mean_hundredths(40, prepare, one));
}

}  // namespace
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

int main() {
  SysTick::start();
  count_predictors();
  count_front_end();
  count_node(node.plain, false, "node_step_still", "node_step_moving");
  count_node(*std::construct_at(&node.with_forces, kForceParams), true, "force_step_still",
             "force_step_moving");
  return 0;
}
