// Ten thousand short drives in which any call to the hardware may go wrong: bus, odometer,
// data-ready, storage, power; in which the chip may freeze, lose samples and round, the machine may
// sleep, and the vehicle turn steadily without a pulse. Nothing crashes, nothing that is no number
// is published, and a node with the status healthy has a bias error as small as its interval
// states. Sensors that warm up are driven apart.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "firmware/model/node_model.hpp"
#include "host_tests/support/repetitions.hpp"
#include "host_tests/system/scenario/bias_judge.hpp"
#include "host_tests/system/scenario/faulty_world.hpp"
#include "host_tools/lib/parallel/parallel.hpp"

namespace zerorate::scenario {
namespace {

using hal::testing::Fault;

/// Change of the bias by an interruption of the supply, standard deviation.
constexpr double kTurnOn_rad_s = 0.01 * kDps;

/// Drives of one kind.
struct Campaign {
  std::size_t drives = 0;
  std::uint64_t first = testing::first_seed(1);  ///< number of the first drive, which is its seed
  bool warms = false;                            ///< a fifth of the sensors warm up
  bool expects_warmth = false;                   ///< the model has a table [warm_up]
  /// Instead of the odometer an accelerometer shows when the vehicle stands. A steady turn that
  /// begins and ends without a jolt is left out: nothing tells it from a bias.
  bool by_accelerometer = false;
};

/// A warm-up that is expected is one of 1 deg/s either way, over 5 min.
FaultyNode::Params node_params(const Campaign& campaign) {
  const auto period = core::Duration::nanoseconds(std::llround(kLsm6dsoPeriod_s * 1e9));
  const auto tick = core::Duration::milliseconds(500);
  model::SensorModel sensor = lsm6dso();
  sensor.turn_on = model::TurnOn{.sigma_rad_s = kTurnOn_rad_s};
  if (campaign.expects_warmth) {
    sensor.warm_up = model::WarmUp{.amplitude_sigma_rad_s = 1.0 * kDps, .time_constant_s = 300.0};
  }
  const auto noise = model::make_node_model<kFaultyShape>(sensor, period, tick);
  return {.model = {.modes = noise.modes,
                    .white_variance_rad2_s2 = noise.white_variance_rad2_s2,
                    .measurement_floor_variance_rad2_s2 = noise.measurement_floor_variance_rad2_s2,
                    .turn_on_variance_rad2_s2 = noise.turn_on_variance_rad2_s2,
                    .largest_bias_rad_s = noise.largest_bias_rad_s,
                    .gate = {.threshold_sigma = 5.0F, .longest_knock_ticks = 20},
                    .sample_period = period,
                    .hypotheses = noise.hypotheses},
          .standstill = {.source = campaign.by_accelerometer ? core::StandstillSource::gyro
                                                             : core::StandstillSource::odometer}};
}

class Drive {
 public:
  Drive(const Campaign& campaign, std::uint64_t number)
      : random_(number),
        chip_random_(~number),
        force_random_(number ^ 0x5555555555555555U),
        by_accelerometer_(campaign.by_accelerometer),
        unseen_(unseen_of(number, campaign)),
        params_(params_of(campaign)),
        rows_(random_drive(random_, unseen_)) {
    smooth_biases(rows_);
    draw_bus_faults();
    draw_wire_faults();
    const double end_s = static_cast<double>(rows_.back().row.time_ns) * 1e-9;
    chip_faults_ = random_chip_faults(chip_random_, end_s);
    force_faults_ = random_force_faults(force_random_, end_s);
    // A program that begins anew has not seen the noise of axes that are frozen already.
    if (chip_faults_.frozen.length_s > 0.0) wires_.restart_s = ChipFaults::kNever;
  }

  /// Faults that are still to come.
  [[nodiscard]] std::string description() const {
    return describe(chip_faults_) + describe(unseen_) + describe(wires_);
  }

  Outcome run() {
    for (row_ = 0; row_ < rows_.size(); ++row_) {
      const double time_s = static_cast<double>(rows_[row_].row.time_ns) * 1e-9;
      if (time_s >= wires_.restart_s) restart();
      odometer_.set_broken(wires_.odometer_error.is_on(time_s));
      ready_.set_broken(wires_.data_ready_dead.is_on(time_s));
      storage_.set_error(wires_.storage_error.is_on(time_s) ? std::optional{hal::StorageError::full}
                                                            : std::nullopt);
      clock_.advance_to(core::Instant::from_ns(rows_[row_].row.time_ns));
      suspend_and_cut(time_s);
      count_pulses(time_s);
      measure(time_s);
      if (by_accelerometer_) measure_force(time_s);
      judge_.go_to(row_);
      loop_->poll();
    }
    return judge_.outcome();
  }

 private:
  using Device = hal::sim::SimulatedSpiDevice<hal::sim::SimulatedLsm6dso>;
  using Bus = hal::testing::FaultInjector<Device>;
  using Gyro = drivers::Lsm6dso<drivers::SpiRegisters<Bus>>;
  using Loop = app::NodeLoop<FaultyNode, Gyro, FaultyOdometer, FaultyPin, SleepingClock, Judge>;

  [[nodiscard]] static Unseen unseen_of(std::uint64_t number, const Campaign& campaign) {
    constexpr std::uint64_t kOfItsOwn = std::uint64_t{1} << 40U;
    Random random{kOfItsOwn + number};
    Unseen unseen = random_unseen(random);
    if (campaign.warms || campaign.by_accelerometer) unseen.turns_before = 0;
    if (!campaign.warms) unseen.warm_up_dps = {};
    return unseen;
  }
  static const FaultyNode::Params& params_of(const Campaign& campaign) {
    static const FaultyNode::Params plain = node_params({});
    static const FaultyNode::Params warm = node_params({.expects_warmth = true});
    static const FaultyNode::Params alone = node_params({.by_accelerometer = true});
    if (campaign.by_accelerometer) return alone;
    return campaign.expects_warmth ? warm : plain;
  }

  void draw_bus_faults() {
    const auto calls = static_cast<double>(4 * rows_.size());
    for (int faults = 0; faults < 3; ++faults) {
      if (happens(random_, 0.5)) continue;
      bus_.inject({.kind = static_cast<Fault::Kind>(random_() % 5),
                   .first = static_cast<std::size_t>(uniform(random_, 0.0, calls)),
                   .calls = happens(random_, 0.5) ? 1 : static_cast<std::size_t>(random_() % 400),
                   .error = hal::BusError::io,
                   .bit = static_cast<std::size_t>(random_() % 96)});
    }
  }
  void draw_wire_faults() {
    const double end_s = static_cast<double>(rows_.back().row.time_ns) * 1e-9;
    for (Episode* const episode :
         {&wires_.odometer_error, &wires_.odometer_bounces, &wires_.odometer_dead,
          &wires_.data_ready_dead, &wires_.storage_error}) {
      if (happens(random_, 0.8)) continue;
      *episode = {.from_s = uniform(random_, 0.0, end_s), .length_s = uniform(random_, 0.1, 20.0)};
    }
    if (happens(random_, 0.2)) wires_.restart_s = uniform(random_, 0.0, end_s);
  }

  void count_pulses(double time_s) {
    const std::int64_t before = row_ == 0 ? 0 : rows_[row_ - 1].row.odometer_pulses;
    if (rows_[row_].row.odometer_pulses == before || wires_.odometer_dead.is_on(time_s)) return;
    const int edges = wires_.odometer_bounces.is_on(time_s) ? 20 : 1;
    for (int edge = 0; edge < edges; ++edge) {
      odometer_.wheel().pulse(clock_.now() - core::Duration::microseconds(2000 - 100 * edge));
    }
  }
  void suspend_and_cut(double time_s) {
    if (time_s >= chip_faults_.suspend_s) {
      chip_faults_.suspend_s = ChipFaults::kNever;
      sleeping_.sleep(core::Duration::nanoseconds(std::llround(chip_faults_.slept_s * 1e9)));
    }
    if (time_s < chip_faults_.power_cut_s) return;
    chip_faults_.power_cut_s = ChipFaults::kNever;
    chip_.cycle_power();
    std::normal_distribution<float> change{0.0F, static_cast<float>(kTurnOn_rad_s)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float by_rad_s = change(chip_random_);
      for (std::size_t row = row_; row < rows_.size(); ++row) {
        rows_[row].bias_rad_s[axis] += by_rad_s;
      }
    }
  }
  void measure(double time_s) {
    std::array<core::AngularRate, 3> rate{};
    const double sigma = simulate::kScenarioArwDpsRtS * kDps / std::sqrt(kLsm6dsoPeriod_s);
    std::normal_distribution<double> white{0.0, sigma};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rate[axis] =
          core::rad_per_s(rows_[row_].true_rate_rad_s[axis] + rows_[row_].bias_rad_s[axis] +
                          static_cast<float>(white(random_)));
    }
    if (chip_faults_.half_rate.is_on(time_s) && row_ % 2 == 1) return;
    distort(rate, time_s);
    chip_.measure(rate, core::Temperature::from_degc(25.0F));
  }
  /// Specific force of a car: acceleration, curves and the road, and the noise of the chip.
  void measure_force(double time_s) {
    constexpr double kGravity_mps2 = 9.80665;
    constexpr double kNoise_g = 0.001;
    constexpr double kRoad_g_per_mps = 0.002;
    if (force_faults_.absent.is_on(time_s)) return;
    const auto& row = rows_[row_];
    const double speed = double{row.row.speed_m_s};
    const double before = row_ == 0 ? speed : double{rows_[row_ - 1].row.speed_m_s};
    std::array<double, 3> force_g{(speed - before) / kLsm6dsoPeriod_s / kGravity_mps2,
                                  speed * double{row.true_rate_rad_s[2]} / kGravity_mps2, 1.0};
    std::normal_distribution<double> shake{0.0, kNoise_g + kRoad_g_per_mps * speed};
    std::array<core::Acceleration, 3> force{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double reading_g = force_faults_.scale * (force_g[axis] + shake(force_random_));
      force[axis] = core::standard_gravity(static_cast<float>(reading_g));
    }
    if (force_faults_.frozen.is_on(time_s)) force = newest_force_;
    newest_force_ = force;
    if (force_faults_.infinite.is_on(time_s)) {
      force.fill(core::standard_gravity(std::numeric_limits<float>::infinity()));
    }
    node_->take_acceleration(clock_.now(), force);
  }
  void distort(std::array<core::AngularRate, 3>& rate, double time_s) {
    const auto step_rad_s = static_cast<float>(chip_faults_.rounding_dps * kDps);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (step_rad_s > 0.0F) {
        const float steps = rate[axis].in(core::rad_per_s) / step_rad_s;
        rate[axis] = core::rad_per_s(std::round(steps) * step_rad_s);
      }
      const bool is_frozen =
          chip_faults_.frozen.is_on(time_s) && (chip_faults_.frozen_axes >> axis & 1U) != 0;
      if (is_frozen) rate[axis] = given_[axis];
      given_[axis] = rate[axis];
    }
  }

  /// The program ends with a save, and another one begins; the chip kept its power.
  void restart() {
    wires_.restart_s = std::numeric_limits<double>::infinity();
    const app::Snapshot<FaultyNode> snapshot{params_, 1};
    const app::SnapshotTime saved{.session = {'a'}, .utc_s = 1000};
    (void)storage_.save(snapshot.of_state(node_->state(), saved));
    node_.emplace(params_);
    std::array<std::uint8_t, app::Snapshot<FaultyNode>::kBytesOfState> record{};
    bool has_memory = false;
    if (const auto size = storage_.load(record)) {
      const app::SnapshotTime now{.session = {happens(random_, 0.5) ? 'a' : 'b'}, .utc_s = 1010};
      has_memory = snapshot.restore(*node_, std::span{record}.first(*size), now).has_value();
    }
    judge_.restart(has_memory);
    gyro_.emplace(drivers::SpiRegisters{bus_}, kSettings);
    loop_.emplace(*node_, *gyro_, odometer_, ready_, sleeping_, judge_);
  }

  static constexpr drivers::lsm6dso::Settings kSettings{
      .rate = drivers::lsm6dso::OutputDataRate::hz_104, .mode = drivers::lsm6dso::Mode::data_ready};

  Random random_;
  Random chip_random_;
  Random force_random_;
  bool by_accelerometer_;
  Unseen unseen_;
  const FaultyNode::Params& params_;
  std::vector<simulate::ScenarioRow> rows_;
  WireFaults wires_;
  ChipFaults chip_faults_;
  ForceFaults force_faults_;
  std::array<core::Acceleration, 3> newest_force_{};
  std::array<core::AngularRate, 3> given_{};  ///< newest conversion
  hal::sim::SimulatedClock clock_;
  SleepingClock sleeping_{clock_};
  hal::sim::SimulatedLsm6dso chip_{clock_};
  Device device_{chip_};
  Bus bus_{device_};
  FaultyOdometer odometer_;
  FaultyPin ready_{chip_.interrupt()};
  hal::sim::SimulatedStorage storage_;
  Judge judge_{rows_};
  std::optional<FaultyNode> node_{std::in_place, params_};
  std::optional<Gyro> gyro_{std::in_place, drivers::SpiRegisters{bus_}, kSettings};
  std::optional<Loop> loop_{std::in_place, *node_, *gyro_, odometer_, ready_, sleeping_, judge_};
  std::size_t row_ = 0;
};

/// Bound of a sum of rare independent events, exceeded once in ten thousand campaigns.
std::size_t poisson_quantile(double mean) {
  double probability = std::exp(-mean);
  double below = probability;
  std::size_t count = 0;
  while (1.0 - below > 1e-4) below += probability *= mean / static_cast<double>(++count);
  return count;
}

// A bias of its own has each axis in each stop: that its error exceeds five standard deviations
// somewhere has the probability of 5.7e-7, nine times a drive.
/// @return drives with a healthy bias that was wrong
std::size_t drive_all(const Campaign& campaign) {
  std::vector<Outcome> outcomes(campaign.drives);
  parallel::for_each(
      outcomes.size(), 0,
      [&](std::size_t i) { outcomes[i] = Drive(campaign, campaign.first + i).run(); }, {});
  Outcome sum;
  std::size_t wrong = 0;
  std::size_t began_in_turn = 0;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Outcome& one = outcomes[i];
    sum.messages += one.messages;
    sum.healthy += one.healthy;
    sum.no_numbers += one.no_numbers;
    sum.restarts_with_memory += one.restarts_with_memory;
    const BiasError& error = one.worst.is_wrong() ? one.worst : one.worst_after_turn;
    if (!error.is_wrong()) continue;
    ++(one.worst.is_wrong() ? wrong : began_in_turn);
    const unsigned long long number = campaign.first + i;
    std::printf("drive %llu: healthy, and off by %.1f standard deviations at %.1f s%s\n", number,
                error.sigmas, error.time_s, Drive(campaign, number).description().c_str());
  }
  std::printf("%zu drives, %llu messages, %.1f %% of them healthy, %llu restarts with memory\n",
              outcomes.size(), static_cast<unsigned long long>(sum.messages),
              100.0 * static_cast<double>(sum.healthy) / static_cast<double>(sum.messages),
              static_cast<unsigned long long>(sum.restarts_with_memory));
  std::printf(
      "healthy and off by more than 5 standard deviations: %zu drives, and %zu that turned "
      "before anything was learnt\n",
      wrong, began_in_turn);
  EXPECT_EQ(sum.no_numbers, 0U);
  return wrong;
}
void expect_honest_health(const Campaign& campaign) {
  EXPECT_LE(drive_all(campaign),
            poisson_quantile(9.0 * 5.7e-7 * static_cast<double>(campaign.drives)));
}

TEST(NodeOverTwoThousandFaultyDrives, NeverCallsWrongBiasHealthy) {
  expect_honest_health({.drives = 2'000});
}
TEST(NodeOverTenThousandFaultyDrives, NeverCallsWrongBiasHealthy) {
  expect_honest_health({.drives = 10'000});
}
TEST(NodeOverTwoThousandFaultyDrives, IsAsHonestByAnAccelerometer) {
  expect_honest_health({.drives = 2'000, .by_accelerometer = true});
}
TEST(NodeOverTenThousandFaultyDrives, IsAsHonestByAnAccelerometer) {
  expect_honest_health({.drives = 10'000, .by_accelerometer = true});
}
TEST(NodeOverWarmingDrives, IsWrongLessOftenByAModelWithAWarmUp) {
  const Campaign plain{.drives = 2'000, .warms = true};
  Campaign expecting = plain;
  expecting.expects_warmth = true;
  EXPECT_LT(5 * drive_all(expecting), drive_all(plain));
}

}  // namespace
}  // namespace zerorate::scenario
