// pico_scenario drive DURATION_S SEED      writes a scenario
// pico_scenario replay < SCENARIO          writes what a Pico must send: stuffed rate frames
//
// The replay is the node of the board's image (firmware/boards/pico/node.hpp) with its driver, on a
// simulated chip instead of an emulated processor.

#include <array>
#include <cstdint>
#include <exception>
#include <iostream>
#include <span>
#include <string>

#include "core/base/time.hpp"
#include "drivers/common/register_access.hpp"
#include "firmware/app/node_loop.hpp"
#include "firmware/boards/pico/node.hpp"
#include "firmware/wire/cobs.hpp"
#include "firmware/wire/rate_frame.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/lsm6dso.hpp"
#include "hal/sim/odometer.hpp"
#include "host_tests/emulated/pico/scenario.hpp"

namespace zerorate::emulated {
namespace {

/// Writes each message as the board's console does.
struct FrameWriter {
  void publish(const app::RateMessage& message) {
    const auto frame = wire::encode_rate_frame({.sequence = sequence++, .message = message});
    std::array<std::uint8_t, wire::cobs_bytes(wire::kMostRateFrameBytes)> stuffed{};
    const std::size_t size = wire::encode_cobs(frame.bytes(), stuffed);
    for (const std::uint8_t byte : std::span{stuffed}.first(size)) {
      std::cout.put(static_cast<char>(byte));
    }
  }
  std::uint32_t sequence = 0;
};

void replay(const Scenario& scenario) {
  using Device = hal::sim::SimulatedSpiDevice<hal::sim::SimulatedLsm6dso>;
  hal::sim::SimulatedClock clock;
  hal::sim::SimulatedLsm6dso chip(clock);
  hal::sim::SimulatedOdometer odometer;
  Device device(chip);
  drivers::Lsm6dso gyro(drivers::SpiRegisters{device}, pico::kGyroSettings);
  pico::Node node(exported::kNodeParams);
  FrameWriter line;
  app::NodeLoop loop(node, gyro, odometer, chip.interrupt(), clock, line);

  const core::AngularRate lsb = drivers::lsm6dso::lsb(pico::kGyroSettings.full_scale);
  const auto instant = [](std::int64_t us) { return core::Instant::from_ns(us * 1000); };
  while (!scenario.empty() && clock.now() < instant(scenario.front().time_us - 1000)) {
    clock.advance(core::Duration::milliseconds(1));
    loop.poll();
  }
  for (const Event& event : scenario) {
    clock.advance_to(instant(event.time_us));
    if (event.is_pulse) {
      odometer.pulse(clock.now());
    } else {
      chip.measure(
          {lsb * event.rate[0], lsb * event.rate[1], lsb * event.rate[2]},
          core::Temperature::from_degc(25.0F + static_cast<float>(event.temperature) / 256.0F));
    }
    loop.poll();
  }
}

int run(std::span<char*> arguments) {
  const std::string command = arguments.size() > 1 ? arguments[1] : "";
  if (command == "drive" && arguments.size() == 4) {
    write_scenario(make_drive(std::stod(arguments[2]), std::stoull(arguments[3])), std::cout);
  } else if (command == "replay" && arguments.size() == 2) {
    replay(read_scenario(std::cin));
  } else {
    std::cerr << "usage: pico_scenario drive DURATION_S SEED | pico_scenario replay < SCENARIO\n";
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace zerorate::emulated

int main(int argc, char** argv) {
  try {
    return zerorate::emulated::run({argv, static_cast<std::size_t>(argc)});
  } catch (const std::exception& error) {
    std::cerr << "pico_scenario: " << error.what() << '\n';
    return 3;
  }
}
