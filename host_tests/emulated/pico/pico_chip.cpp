// pico_chip CHIP REQUESTS REPLIES
//
// A simulated gyro of hal/sim for an emulated processor: reads requests from one named pipe, a line
// each, and answers into the other, so that a byte on the emulated bus waits for its reply.
//
//   m NS X Y Z C   a conversion of these rates [deg/s] at this temperature [degC]
//   r NS ADDRESS   reads a register         w NS ADDRESS VALUE   writes one
//   p NS           the reply that is on the wire next
//   f NS FRAME     exchanges a frame, or a word
//   s NS           selects a chip of words
//   u NS ADDRESS BITS   flips bits of a register, as an upset does
//
// NS is the time. The answer: value, address that follows, level of the interrupt pin, whether it
// had an edge since the last answer.

#include <array>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "hal/sim/buses.hpp"
#include "hal/sim/chips.hpp"
#include "hal/sim/clock.hpp"
#include "hal/sim/register_chip.hpp"

namespace zerorate::emulated {
namespace {

struct Answer {
  std::uint32_t value = 0;
  unsigned next = 0;
};

/// The MPU-6050, which is the same simulated chip with another identity.
class Mpu6050 : public hal::sim::SimulatedMpu6500 {
 public:
  static constexpr std::string_view kName = "mpu6050";
  explicit Mpu6050(const hal::sim::SimulatedClock& clock)
      : SimulatedMpu6500(clock, kIdentityMpu6050) {}
};

Answer answer_to(hal::sim::RegisterChip auto& chip, char kind, std::istream& words) {
  unsigned address = 0;
  unsigned value = 0;
  words >> address;
  const auto at = static_cast<std::uint8_t>(address);
  const unsigned next = chip.next_address(at);
  if (kind == 'r') return {.value = chip.read_register(at), .next = next};
  if (kind != 'w' || !(words >> value)) throw std::runtime_error("not a request to a register");
  chip.write_register(at, static_cast<std::uint8_t>(value));
  return {.next = next};
}

Answer answer_to(hal::sim::SimulatedAdxrs453& chip, char kind, std::istream& words) {
  std::uint32_t frame = 0;
  if (kind == 'p') {
    hal::sim::SimulatedAdxrs453 copy = chip;  // the reply stands before the command is heard
    return {.value = copy.exchange_frame(frame)};
  }
  if (kind != 'f' || !(words >> frame)) throw std::runtime_error("not a request for a frame");
  return {.value = chip.exchange_frame(frame)};
}

Answer answer_to(hal::sim::WordChip auto& chip, char kind, std::istream& words) {
  std::uint16_t word = 0;
  if (kind == 'p') return {.value = chip.reply()};
  if (kind == 's') {
    chip.select();
  } else if (kind == 'f' && words >> word) {
    chip.take(word);
  } else {
    throw std::runtime_error("not a request for a word");
  }
  return {};
}

template <class Chip>
void measure(Chip& chip, std::istream& words) {
  std::array<double, 3> dps{};
  double degc = 0.0;
  words >> dps[0] >> dps[1] >> dps[2] >> degc;
  const auto rate = [&](std::size_t i) { return core::deg_per_s(static_cast<float>(dps.at(i))); };
  chip.measure({rate(0), rate(1), rate(2)}, core::Temperature::from_degc(static_cast<float>(degc)));
}

template <class Chip>
void upset(Chip& chip, std::istream& words) {
  unsigned address = 0;
  unsigned bits = 0;
  words >> address >> bits;
  chip.upset(static_cast<std::uint8_t>(address), static_cast<std::uint8_t>(bits));
}

template <class Chip>
void serve(std::istream& requests, std::ostream& replies) {
  hal::sim::SimulatedClock clock;
  Chip chip(clock);
  char kind = 0;
  std::int64_t ns = 0;
  while (requests >> kind >> ns) {
    clock.advance_to(core::Instant::from_ns(ns));
    Answer answer;
    if (kind == 'm') {
      measure(chip, requests);
    } else if (kind == 'u') {
      upset(chip, requests);
    } else {
      answer = answer_to(chip, kind, requests);
    }
    if (!requests) throw std::runtime_error(std::string("request ") + kind + " lacks a number");
    bool level = false;
    bool had_edge = false;
    if constexpr (requires { chip.interrupt(); }) {
      level = chip.interrupt().level();
      had_edge = chip.interrupt().take_edge().has_value();
    }
    replies << answer.value << ' ' << answer.next << ' ' << level << ' ' << had_edge << std::endl;
  }
}

int run(std::span<char*> arguments) {
  if (arguments.size() != 4) throw std::runtime_error("wants a chip and two named pipes");
  const std::string chip = arguments[1];
  std::ifstream requests(arguments[2]);
  std::ofstream replies(arguments[3]);
  bool is_known = false;
  const auto serve_if_named = [&]<class Chip> {
    if (chip != Chip::kName) return;
    is_known = true;
    serve<Chip>(requests, replies);
  };
  hal::sim::AllSimulatedChips::for_each(serve_if_named);
  serve_if_named.template operator()<Mpu6050>();
  if (!is_known) throw std::runtime_error("no chip " + chip);
  return 0;
}

}  // namespace
}  // namespace zerorate::emulated

int main(int argc, char** argv) {
  try {
    return zerorate::emulated::run({argv, static_cast<std::size_t>(argc)});
  } catch (const std::exception& error) {
    std::cerr << "pico_chip: " << error.what() << '\n';
    return 3;
  }
}
