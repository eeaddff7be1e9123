#include "host_tools/lib/evaluate/simulated_gyro.hpp"

#include <stdexcept>

#include "drivers/adxrs453/driver.hpp"
#include "drivers/bmi088/driver.hpp"
#include "drivers/common/frame_bus.hpp"
#include "drivers/common/register_bus.hpp"
#include "drivers/icm42688/driver.hpp"
#include "drivers/lsm6dso/driver.hpp"
#include "hal/sim/adxrs453.hpp"
#include "hal/sim/bmi088.hpp"
#include "hal/sim/frame_spi.hpp"
#include "hal/sim/icm42688.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/sim/spi.hpp"

namespace zerorate::evaluate {
namespace {

/// @tparam Device  how the chip hangs on SPI
/// @tparam Link    what the driver talks through
template <class SimulatedChip, class Device, class Link, class Driver>
class Assembled final : public SimulatedGyro {
 public:
  template <class Settings>
  Assembled(const hal::sim::SimulatedClock& clock, const Settings& settings)
      : chip_(clock), device_(chip_), driver_(Link{device_}, settings) {}

  void measure(const std::array<core::AngularRate, 3>& rate,
               core::Temperature temperature) override {
    chip_.measure(rate, temperature);
  }
  hal::sim::DataReadyPin& interrupt() override {
    if constexpr (requires { chip_.interrupt(); }) {
      return chip_.interrupt();
    } else {
      return no_pin_;
    }
  }
  core::Result<void, drivers::DriverError> start(core::Instant now) override {
    return driver_.start(now);
  }
  core::Result<std::size_t, drivers::DriverError> read(
      core::Instant now, std::span<drivers::GyroSample> out) override {
    return driver_.read(now, out);
  }
  core::Result<void, drivers::DriverError> verify_next() override { return driver_.verify_next(); }
  [[nodiscard]] core::Duration sample_period() const override { return driver_.sample_period(); }
  [[nodiscard]] bool is_batched() const override { return driver_.is_batched(); }

 private:
  SimulatedChip chip_;
  Device device_;
  Driver driver_;
  hal::sim::DataReadyPin no_pin_;
};

template <class SimulatedChip, template <class> class Driver, class Settings>
std::unique_ptr<SimulatedGyro> on_registers(const hal::sim::SimulatedClock& clock,
                                            const Settings& settings) {
  using Device = hal::sim::SimulatedSpiDevice<SimulatedChip>;
  using Link = drivers::SpiRegisters<Device>;
  return std::make_unique<Assembled<SimulatedChip, Device, Link, Driver<Link>>>(clock, settings);
}

std::unique_ptr<SimulatedGyro> on_frames(const hal::sim::SimulatedClock& clock) {
  using Device = hal::sim::SimulatedFrameSpi<hal::sim::SimulatedAdxrs453>;
  using Link = drivers::SpiFrames<Device>;
  // The chip has no rate of its own; shorter than any recording's, each row is due.
  const drivers::adxrs453::Settings settings{.sample_period = core::Duration::microseconds(1)};
  return std::make_unique<
      Assembled<hal::sim::SimulatedAdxrs453, Device, Link, drivers::Adxrs453<Link>>>(clock,
                                                                                     settings);
}

}  // namespace

std::string_view name(Chip chip) {
  switch (chip) {
    case Chip::lsm6dso:
      return "lsm6dso";
    case Chip::icm42688:
      return "icm42688";
    case Chip::bmi088:
      return "bmi088";
    case Chip::adxrs453:
      return "adxrs453";
  }
  return "unknown";
}

std::size_t axis_count(Chip chip) {
  return chip == Chip::adxrs453 ? 1 : 3;
}

std::unique_ptr<SimulatedGyro> make_simulated_gyro(Chip chip,
                                                   const hal::sim::SimulatedClock& clock) {
  switch (chip) {
    case Chip::lsm6dso:
      return on_registers<hal::sim::SimulatedLsm6dso, drivers::Lsm6dso>(
          clock, drivers::lsm6dso::Settings{});
    case Chip::icm42688:
      return on_registers<hal::sim::SimulatedIcm42688, drivers::Icm42688>(
          clock, drivers::icm42688::Settings{});
    case Chip::bmi088:
      return on_registers<hal::sim::SimulatedBmi088, drivers::Bmi088>(clock,
                                                                      drivers::bmi088::Settings{});
    case Chip::adxrs453:
      return on_frames(clock);
  }
  throw std::invalid_argument("unknown chip");
}

}  // namespace zerorate::evaluate
