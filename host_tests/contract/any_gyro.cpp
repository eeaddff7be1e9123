#include "host_tests/contract/any_gyro.hpp"

#include <algorithm>
#include <iterator>
#include <type_traits>

#include "host_tests/support/simulated_accelerometers.hpp"
#include "host_tests/support/simulated_gyros.hpp"

namespace zerorate::contract {
namespace {

using support::GyroRig;

template <class Gyro>
typename Gyro::Settings settings_of(Setting setting) {
  switch (setting.kind) {
    case Setting::Kind::data_ready:
      return Gyro::kDataReady;
    case Setting::Kind::fifo:
      return Gyro::kFifo;
    case Setting::Kind::range:
      return Gyro::kRanges.at(setting.range).settings;
    case Setting::Kind::usual:
      break;
  }
  return {};
}

template <class Wiring>
class RigOf final : public AnyRig {
 public:
  using Gyro = typename Wiring::Gyro;

  RigOf(Setting setting, core::Instant begin) : rig_(settings_of<Gyro>(setting), begin) {}

  hal::sim::SimulatedClock& clock() override { return rig_.clock; }
  hal::testing::Faults& faults() override { return rig_.faults; }

  Done start_once() override { return rig_.driver.start(rig_.clock.now()); }
  Done start() override { return rig_.start(); }
  Done start_and_settle() override { return rig_.start_and_settle(); }
  Count read(core::Instant now, std::span<core::GyroSample> out) override {
    return rig_.driver.read(now, out);
  }
  Done verify_next() override { return rig_.driver.verify_next(); }
  core::Duration sample_period() const override { return rig_.driver.sample_period(); }

  void measure(const Rates& rate, core::Temperature temperature) override {
    rig_.chip.measure(rate, temperature);
  }
  void upset(std::uint8_t address, std::uint8_t flipped_bits) override {
    rig_.chip.upset(address, flipped_bits);
  }
  void cycle_power() override { rig_.chip.cycle_power(); }
  bool is_powered() const override { return rig_.chip.is_powered(); }
  std::size_t reserved_writes() const override { return rig_.chip.reserved_writes(); }

  hal::sim::DataReadyPin* interrupt() override {
    if constexpr (requires { rig_.chip.interrupt(); }) return &rig_.chip.interrupt();
    return nullptr;
  }
  bool is_relative([[maybe_unused]] std::uint8_t flipped_bits) override {
    if constexpr (requires { Gyro::kIdentities; }) {
      const int identity = rig_.chip.read_register(Gyro::kIdentity) ^ flipped_bits;
      return std::ranges::find(Gyro::kIdentities, identity) != Gyro::kIdentities.end();
    }
    return false;
  }
  void set_specific_force([[maybe_unused]] const Force& force,
                          [[maybe_unused]] core::Acceleration noise) override {
    if constexpr (requires { Gyro::kLsbG; }) rig_.chip.set_specific_force(force, noise);
  }
  void lose_accelerations([[maybe_unused]] int conversions) override {
    if constexpr (requires { Gyro::kLsbG; }) rig_.chip.lose_accelerations(conversions);
  }

 private:
  GyroRig<Wiring> rig_;
};

template <class Wiring>
std::unique_ptr<AnyRig> make_rig(Setting setting, core::Instant begin) {
  return std::make_unique<RigOf<Wiring>>(setting, begin);
}

/// Wiring of the same chip with the driver of the gyro alone.
template <class Wiring>
struct PlainOf;
template <template <class> class Over, class Gyro>
struct PlainOf<Over<Gyro>> {
  using Type = Over<typename Gyro::Plain>;
};
template <class Gyro>
struct PlainOf<support::OverI2cTwice<Gyro>> {
  using Type = support::OverI2c<typename Gyro::Plain>;
};

template <class Wiring>
constexpr bool kIsOverI2c = std::is_same_v<Wiring, support::OverI2c<typename Wiring::Gyro>> ||
                            std::is_same_v<Wiring, support::OverI2cTwice<typename Wiring::Gyro>>;

/// Facts that only some descriptions have.
template <class Wiring>
void add_particulars(AnyGyro& gyro) {
  using Gyro = typename Wiring::Gyro;
  if constexpr (requires { Gyro::kReadTransactions; }) {
    gyro.read_transactions = Gyro::kReadTransactions;
  }
  if constexpr (requires { Gyro::kReadingReleasesPin; }) {
    gyro.reading_releases_pin = Gyro::kReadingReleasesPin;
  }
  if constexpr (requires { Gyro::kFifoCapacity; }) {
    gyro.fifo_capacity = Gyro::kFifoCapacity;
    gyro.has_watermark = Gyro::kHasWatermark;
  }
  if constexpr (requires { Gyro::kLsbG; }) {
    gyro.lsb_g = Gyro::kLsbG;
    gyro.range_g = Gyro::kRangeG;
    gyro.can_lose_acceleration = Gyro::kCanLoseAcceleration;
    gyro.acceleration_is_marked = Gyro::kAccelerationIsMarked;
    gyro.make_plain = make_rig<typename PlainOf<Wiring>::Type>;
  }
}

template <class Wiring>
AnyGyro describe() {
  using Gyro = typename Wiring::Gyro;
  AnyGyro gyro{.name = std::string{Gyro::kName} + (kIsOverI2c<Wiring> ? "OverI2c" : "OverSpi"),
               .lsb_dps = Gyro::kLsbDps,
               .full_scale_dps = Gyro::kFullScaleDps,
               .lowest_raw = Gyro::kLowestRaw,
               .temperature_lsb = Gyro::kTemperatureLsb,
               .is_single_axis = Wiring::Driver::kAxes == 1,
               .frames_are_marked = Gyro::kFramesAreMarked,
               .is_sampled_by_reading = Gyro::kIsSampledByReading,
               .verify_transactions = Gyro::kVerifyTransactions,
               .identity = Gyro::kIdentity,
               .configured = Gyro::kConfigured,
               .start_time = Gyro::kStartTime,
               .earliest = Gyro::kEarliest,
               .latest = Gyro::kLatest,
               .make = make_rig<Wiring>};
  for (const auto& range : Gyro::kRanges) gyro.ranges.push_back({range.lsb_dps, range.span_dps});
  add_particulars<Wiring>(gyro);
  return gyro;
}

template <class... Wirings>
void add(std::vector<AnyGyro>& gyros, core::TypeList<Wirings...>) {
  (gyros.push_back(describe<Wirings>()), ...);
}

template <class Predicate>
std::vector<AnyGyro> gyros_where(Predicate is_wanted) {
  std::vector<AnyGyro> wanted;
  std::ranges::copy_if(all_gyros(), std::back_inserter(wanted), is_wanted);
  return wanted;
}

}  // namespace

std::vector<core::GyroSample> AnyRig::read_all() {
  std::vector<core::GyroSample> all;
  std::array<core::GyroSample, 16> out{};
  std::size_t count = out.size();
  while (count == out.size()) {
    count = read(out).value_or(0);
    all.insert(all.end(), out.begin(), out.begin() + static_cast<std::ptrdiff_t>(count));
  }
  return all;
}

const std::vector<AnyGyro>& all_gyros() {
  static const std::vector<AnyGyro> kGyros = [] {
    std::vector<AnyGyro> gyros;
    add(gyros, support::WiringsWithFifo{});
    add(gyros, support::WiringsWithAcceleration{});
    add(gyros, support::WiringsWithAccelerationAlone{});
    add(gyros, support::WiringsWithoutFifo{});
    return gyros;
  }();
  return kGyros;
}

std::vector<AnyGyro> gyros_with_fifo() {
  return gyros_where([](const AnyGyro& gyro) { return gyro.fifo_capacity > 0; });
}

std::vector<AnyGyro> gyros_with_acceleration() {
  return gyros_where([](const AnyGyro& gyro) { return gyro.lsb_g > 0.0F; });
}

}  // namespace zerorate::contract
