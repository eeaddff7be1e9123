// Links everything that is meant to be flashed into images that nobody runs: what compiles on the
// host but allocates, throws or computes in double precision is found here, on the first day. One
// image has the core and a node, one every driver, and one those that read the accelerometer, too.

#include <cstdint>

#include "core/base/numeric.hpp"
#include "core/base/result.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "core/estimator/bias_predictor.hpp"
#include "core/estimator/calibration_mean.hpp"
#include "core/estimator/kalman_predictor.hpp"
#include "core/estimator/moving_average.hpp"
#include "core/noise/modes.hpp"
#include "core/noise/terms.hpp"
#include "drivers/chips/chips.hpp"
#include "drivers/common/register_access.hpp"
#include "firmware/app/gyro_node.hpp"
#include "firmware/app/node_loop.hpp"

// NOLINTBEGIN(cppcoreguidelines-avoid-non-const-global-variables): firmware's state is static
namespace {

using namespace zerorate;

// The outside world: what comes in is unknown to the compiler, and what goes out is seen.
volatile std::int64_t clock_ns;
volatile float gyro_deg_per_s;
volatile float report;

enum class Refusal : std::uint8_t { not_finite };

core::Result<core::AngularRate, Refusal> read_rate() {
  const float rate_deg_per_s = gyro_deg_per_s;
  if (!core::is_finite(rate_deg_per_s)) return core::Unexpected{Refusal::not_finite};
  return core::deg_per_s(rate_deg_per_s);
}

void exercise_base() {
  const auto start = core::Instant::from_ns(clock_ns);
  const core::Duration elapsed = core::Instant::from_ns(clock_ns) - start;
  report = core::to_float(elapsed / core::Duration::milliseconds(10));
  const auto rate = read_rate();
  if (!rate) return;
  report = (*rate * elapsed).in(core::deg);
  report = core::square_root(rate->in(core::deg_per_h));
  report = core::one_minus_exp_neg(elapsed.in_seconds());
}

constexpr auto kTick = core::Duration::milliseconds(10);

constexpr core::ModelShape kShape{.decaying = 7, .rotating = 1};

/// A sensor with every noise block that there is; the figures are of no importance.
core::ModesOf<kShape> sensor_noise() {
  const float sigma_rad_s = gyro_deg_per_s * core::kRadPerDeg;
  core::FlickerDecades<4> flicker;
  flicker.time_constant_s = {1.0F, 10.0F, 100.0F, 1e3F};
  flicker.variance_rad2_s2.fill(sigma_rad_s * sigma_rad_s);
  return core::compose(kTick, core::Start::stationary, flicker,
                       core::GaussMarkov{.sigma_rad_s = sigma_rad_s, .time_constant_s = 3.0F},
                       core::Harmonic{.rms_rad_s = sigma_rad_s, .frequency_hz = 7.0F},
                       core::RandomWalk{.coefficient_rad_s_sqrt_s = sigma_rad_s},
                       core::WarmUp{.sigma_rad_s = sigma_rad_s, .time_constant_s = 600.0F},
                       core::RateRamp{.sigma_rad_s2 = sigma_rad_s});
}

// Static, as in firmware: estimators and spans are never put on the stack.
constinit core::ModesOf<kShape> noise{.tick = kTick};
constinit core::TransitionOf<kShape> tick;
constinit core::TransitionOf<kShape> drive;
constexpr core::KalmanCoefficients<kShape> kNoNoise{core::ModesOf<kShape>{.tick = kTick}};
constinit core::KalmanCoefficients<kShape> coefficients{kNoNoise};
constinit core::KalmanPredictor<kShape> kalman{kNoNoise};
constinit core::MovingAverage<kShape> moving_average{noise};
constinit core::CalibrationMean<kShape> calibration_mean{noise};

/// One stop and the drive after it. Not inlined: each predictor shows its own stack frames.
template <core::BiasPredictor Predictor>
[[gnu::noinline]] void exercise(Predictor& predictor) {
  predictor.begin_stop();
  predictor.advance(tick);
  report = predictor.observe(gyro_deg_per_s * core::kRadPerDeg, 1e-6F).residual_rad_s;
  report = predictor.bias_rad_s(tick);
  report = predictor.predict(tick).sigma_rad_s();
  report = predictor.predict_heading(tick, drive).sigma_rad();
}

void exercise_estimators() {
  noise = sensor_noise();
  tick = noise.one_tick();
  drive = noise.over(static_cast<std::uint32_t>(clock_ns));
  coefficients = core::KalmanCoefficients<kShape>{
      noise, core::Gate{.threshold_sigma = 5.0F, .longest_knock_ticks = 10}};
  kalman = core::KalmanPredictor<kShape>{coefficients};
  exercise(kalman);
  exercise(moving_average);
  exercise(calibration_mean);
}

// A whole node, as a board's main would bind it, on hardware that is not there.

struct SomeClock {
  [[nodiscard]] core::Instant now() const { return core::Instant::from_ns(clock_ns); }
};
struct SomePin {
  std::optional<core::Instant> take_edge() { return core::Instant::from_ns(clock_ns); }
};
struct SomeOdometer {
  core::Result<hal::PulseBatch, hal::BusError> read_pulses(std::span<core::Instant> stamps) {
    stamps[0] = core::Instant::from_ns(clock_ns);
    return hal::PulseBatch{.count = 1};
  }
};
struct SomeSpi {
  core::Result<void, hal::BusError> transaction(std::span<const hal::Operation> operations) {
    for (const hal::Operation& operation : operations) {
      for (std::uint8_t& byte : operation.buffer()) byte = static_cast<std::uint8_t>(clock_ns);
    }
    return {};
  }
};
struct SomeSink {
  void publish(const app::RateMessage& message) {
    report = message.axes[2].corrected.in(core::deg_per_s);
  }
};

using Node = app::GyroNode<kShape>;
using Gyro = drivers::Lsm6dso<drivers::SpiRegisters<SomeSpi>>;

constinit SomeClock clock;
constinit SomePin data_ready;
constinit SomeOdometer odometer;
constinit SomeSpi spi;
constinit SomeSink sink;
constexpr Node::Params kParams{.model = {.modes = {.tick = kTick},
                                         .white_variance_rad2_s2 = 1e-6F,
                                         .sample_period = core::Duration::milliseconds(10)},
                               .standstill = {.hold_back = core::Duration::milliseconds(200)}};
void exercise_node() {
  // Made on the first call: a board has run its clocks by then.
  static Node node{kParams};
  static Gyro gyro{drivers::SpiRegisters{spi}};
  static app::NodeLoop loop{node, gyro, odometer, data_ready, clock, sink};
  loop.poll();
}

template <drivers::GyroSource Source>
[[gnu::noinline]] void exercise(Source& gyro) {
  const SomeClock now;
  std::array<drivers::GyroSample, 4> samples{};
  if (!gyro.start(now.now()) || !gyro.verify_next()) return;
  if (!gyro.read(now.now(), samples)) return;
  report = samples[0].rate[0].in(core::rad_per_s);
  if (samples[0].has_acceleration) report = samples[0].acceleration[0].in(core::m_per_s2);
}

/// A driver in memory of its own. Not inlined: chips with the same driver share it.
template <class Gyro, class Link>
[[gnu::noinline]] void exercise_on(Link link) {
  static Gyro gyro{link};
  exercise(gyro);
}

template <class Chip>
void exercise_driver() {
  using Link = drivers::SpiLink<Chip, SomeSpi>;
  exercise_on<typename Chip::template Driver<Link>>(Link{spi});
}

void exercise_drivers() {
  drivers::AllChips::for_each([]<class Chip> { exercise_driver<Chip>(); });
}

template <class Chip>
void exercise_accelerometer() {
  using Link = drivers::SpiLink<Chip, SomeSpi>;
  if constexpr (drivers::TwoDieChipEntry<Chip>) {
    using Die = typename Chip::template AccelerometerSpi<SomeSpi>;
    using Buses = decltype(Chip::buses(Link{spi}, Die{spi}));
    exercise_on<typename Chip::template DriverWithAcceleration<Buses>>(
        Chip::buses(Link{spi}, Die{spi}));
  } else if constexpr (drivers::AccelerometerChipEntry<Chip>) {
    exercise_on<typename Chip::template DriverWithAcceleration<Link>>(Link{spi});
  }
}

void exercise_accelerometers() {
  drivers::AllChips::for_each([]<class Chip> { exercise_accelerometer<Chip>(); });
}

#ifndef ZERORATE_CHECK
#define ZERORATE_CHECK core  // where no image is built
#endif
enum class Part : std::uint8_t { core, drivers, acceleration };
constexpr Part kPart = Part::ZERORATE_CHECK;

}  // namespace
// NOLINTEND(cppcoreguidelines-avoid-non-const-global-variables)

extern "C" [[noreturn]] int main() {
  while (true) {
    if constexpr (kPart == Part::core) {
      exercise_base();
      exercise_estimators();
      exercise_node();
    } else if constexpr (kPart == Part::drivers) {
      exercise_drivers();
    } else {
      exercise_accelerometers();
    }
  }
}
