/// @file
/// A simulated gyro as the emulated machine's bus controllers see it.
#pragma once

#include <array>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <span>

#include "hal/linux/clock.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/chips.hpp"
#include "hal/sim/clock.hpp"
#include "host_tests/emulated/linux/kernel/zerorate_bus.h"

namespace zerorate::emulated {

/// Fresh from power-on when it is made.
class PlayedChip {
 public:
  PlayedChip() = default;
  PlayedChip(const PlayedChip&) = delete;
  PlayedChip& operator=(const PlayedChip&) = delete;
  virtual ~PlayedChip() = default;

  /// Carries one transaction out.
  /// @return 0 or a negative error number
  virtual int transfer(const zerorate_bus_transaction& request,
                       std::span<const hal::Operation> operations) = 0;
  virtual void measure(const std::array<core::AngularRate, 3>& rate) = 0;
  /// Level of the interrupt pin; a chip without one never drives it.
  [[nodiscard]] virtual bool is_data_ready() = 0;
  /// Whether the pin has risen since this was asked last, if only for a pulse.
  [[nodiscard]] virtual bool take_edge() = 0;
  /// Writes to registers that the chip does not have.
  [[nodiscard]] virtual std::size_t reserved_writes() const = 0;
};

/// Temperature of every chip: not where the formulas of their thermometers have their zeros.
inline constexpr core::Temperature kPlayedTemperature = core::Temperature::from_degc(35);

/// @tparam Wiring  how the chip hangs on its bus
template <class Chip, class Wiring>
class Wired final : public PlayedChip {
 public:
  template <class... Address>
  explicit Wired(Address... address) : wiring_(chip_, address...) {}

  int transfer(const zerorate_bus_transaction& request,
               std::span<const hal::Operation> operations) override {
    clock_.advance_to(hal::linux_os::KernelClock::now());
    if constexpr (requires { wiring_.transaction(operations); }) {
      if (request.bus != ZERORATE_BUS_SPI) return -ENXIO;
      return wiring_.transaction(operations) ? 0 : -EIO;
    } else {
      if (request.bus != ZERORATE_BUS_I2C) return -ENXIO;
      const hal::I2cAddress address{static_cast<std::uint8_t>(request.address)};
      return wiring_.transaction(address, operations) ? 0 : -ENXIO;
    }
  }
  void measure(const std::array<core::AngularRate, 3>& rate) override {
    clock_.advance_to(hal::linux_os::KernelClock::now());
    chip_.measure(rate, kPlayedTemperature);
  }
  [[nodiscard]] bool is_data_ready() override {
    if constexpr (requires { chip_.interrupt(); }) {
      return chip_.interrupt().level();
    } else {
      return false;
    }
  }
  [[nodiscard]] bool take_edge() override {
    if constexpr (requires { chip_.interrupt(); }) {
      return chip_.interrupt().take_edge().has_value();
    } else {
      return false;
    }
  }
  [[nodiscard]] std::size_t reserved_writes() const override {
    if constexpr (requires { chip_.reserved_writes(); }) {
      return chip_.reserved_writes();
    } else {
      return 0;
    }
  }

 private:
  hal::sim::SimulatedClock clock_{hal::linux_os::KernelClock::now()};
  Chip chip_{clock_};
  Wiring wiring_;
};

/// Chips with registers on SPI and on I2C, with frames of 32 bits, and with words of 16 on SPI.
template <class Chip>
std::unique_ptr<PlayedChip> on_spi() {
  return std::make_unique<Wired<Chip, hal::sim::SimulatedSpiDevice<Chip>>>();
}
template <class Chip, std::uint8_t kAddress>
std::unique_ptr<PlayedChip> on_i2c() {
  return std::make_unique<Wired<Chip, hal::sim::SimulatedI2cBus<Chip>>>(hal::I2cAddress{kAddress});
}
template <class Chip>
std::unique_ptr<PlayedChip> on_frames() {
  return std::make_unique<Wired<Chip, hal::sim::SimulatedFrameSpi<Chip>>>();
}

template <class Chip>
std::unique_ptr<PlayedChip> on_words() {
  return std::make_unique<Wired<Chip, hal::sim::SimulatedWordSpi<Chip>>>();
}

}  // namespace zerorate::emulated
