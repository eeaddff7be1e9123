/// @file
/// Prints frames of messages with any content beside the values that were written into them, for
/// can_test.py: `frame ID HEX`, `value NAME NUMBER` (nan: there is none), `end` after each message.
/// usage: can_frames_sent axes|yaw|fd ID DATA_ID 11A|11C

#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/wire/can_frames.hpp"
#include "firmware/wire/can_protected.hpp"
#include "host_tests/unit/firmware/wire/messages.hpp"

namespace {

using zerorate::wire::NumberedMessage;
namespace core = zerorate::core;
namespace wire = zerorate::wire;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

void print_frame(unsigned id, std::span<const std::uint8_t> data) {
  std::printf("frame %u ", id);
  for (const std::uint8_t byte : data) std::printf("%02x", byte);
  std::printf("\n");
}

void print_value(std::string_view name, double value) {
  std::printf("value %.*s %.9g\n", static_cast<int>(name.size()), name.data(), value);
}

void print_values(const NumberedMessage& sent) {
  const auto& message = sent.message;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string axis(1, "XYZ"[i]);
    const auto& rate = message.axes.at(i);
    print_value("Rate" + axis,
                message.has_rate() ? double{rate.corrected.in(core::deg_per_s)} : kNone);
    print_value("Bias" + axis, rate.bias.in(core::deg_per_s));
    print_value("Sigma" + axis, rate.sigma.in(core::deg_per_s));
    print_value("Turn" + axis, message.turn.at(i).angle.in(core::deg));
    if (message.up) print_value("Up" + axis, message.up->at(i));
    if (message.acceleration) {
      print_value("Acceleration" + axis, message.acceleration->at(i).in(core::m_per_s2));
    }
  }
  const double yaw = message.up && message.has_rate()
                         ? double{message.vertical_rate().in(core::deg_per_s)}
                         : kNone;
  print_value("YawRate", yaw);
  if (message.up) print_value("RateVertical", yaw);
  if (message.up) print_value("Heading", message.heading.angle.in(core::deg));
  print_value("Temperature", message.temperature ? double{message.temperature->degc()} : kNone);
  print_value("Motion", static_cast<int>(message.motion));
  print_value("Calibrated", message.health.calibrated ? 1 : 0);
  print_value("AccelerationMissing", message.health.acceleration_missing ? 1 : 0);
  print_value("OdometerPulses", message.odometer_pulses.value_or(0));
}

void print_all(std::span<const wire::CanFrame> frames) {
  for (const wire::CanFrame& frame : frames) print_frame(frame.id, frame.data);
}

void print_slow_frames(const NumberedMessage& sent, std::uint16_t id) {
  print_all(wire::encode_can_turn(sent, id));
  const wire::CanFrame inputs = wire::encode_can_inputs(sent, id);
  print_frame(inputs.id, inputs.data);
  if (sent.message.up) {
    for (const wire::CanFrame& frame :
         {wire::encode_can_vertical(sent, id), wire::encode_can_up(sent, id),
          wire::encode_can_vertical_turn(sent, id)}) {
      print_frame(frame.id, frame.data);
    }
  }
  const wire::CanFrame acceleration = wire::encode_can_acceleration(sent, id);
  print_frame(acceleration.id, acceleration.data);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() != 4) return 2;
  const auto id = static_cast<std::uint16_t>(std::stoul(words[1], nullptr, 0));
  const wire::E2eSettings e2e{
      .data_id = static_cast<std::uint16_t>(std::stoul(words[2], nullptr, 0)),
      .variant = words[3] == "11A" ? wire::E2eVariant::both : wire::E2eVariant::nibble};
  std::mt19937_64 random{31};
  for (std::uint32_t i = 0; i < 200; ++i) {
    NumberedMessage sent = wire::testing::random_message(random);
    sent.sequence = i;
    if (words[0] == "yaw") {
      print_frame(id, wire::encode_can_yaw(sent, id, e2e).data);
    } else if (words[0] == "fd") {
      print_frame(id, wire::encode_can_fd(sent, id, e2e).data);
    } else {
      print_all(wire::encode_can_frames(sent, id));
    }
    if (words[0] != "yaw") print_slow_frames(sent, id);
    print_values(sent);
    std::printf("end\n");
  }
  return EXIT_SUCCESS;
}
