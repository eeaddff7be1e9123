/// @file
/// Receives what zerorated publishes and compares it with what the world gave it.
#pragma once

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/wire/rate_frame.hpp"
#include "host_tests/emulated/linux/guest/device_world.hpp"

namespace zerorate::emulated {

inline constexpr float kLsbDps = 8.75e-3F;  // LSM6DSO at 250 deg/s

struct Tally {
  long frames = 0;
  long with_rate = 0;
  long number_gaps = 0;    ///< messages lost on the way
  long wrong_samples = 0;  ///< not the sample that was next
  long faulty = 0;         ///< messages that say sensor_fault
  long odometer_faulty = 0;
  long still = 0;
  double largest_difference_lsb = 0.0;  ///< from the node that runs beside, corrected rate
};

class Witness {
 public:
  Witness(const linux_node::Configuration& configuration, const char* path)
      : params_(configuration.node), node_(params_) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::ranges::copy(std::string(path), std::begin(address.sun_path));
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      give_up(path);
    }
  }

  /// What the world gave, in order.
  void expect(const std::array<core::AngularRate, 3>& rate) { given_.push_back(rate); }
  void pulsed(core::Instant at) { pulses_.push_back(at); }
  /// After a fault: the next sample may be any of those given from now on.
  void forget_given() {
    given_.clear();
    is_in_step_ = false;
  }

  void receive() {
    std::array<std::uint8_t, 128> bytes{};
    for (;;) {
      const ssize_t size = recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (size < 0) return;
      const auto frame =
          wire::decode_rate_frame(std::span{bytes}.first(static_cast<std::size_t>(size)));
      if (!frame) give_up("a datagram that is no frame");
      take(*frame);
    }
  }

  [[nodiscard]] const Tally& tally() const { return tally_; }
  [[nodiscard]] const std::optional<wire::NumberedMessage>& newest() const { return newest_; }

 private:
  void take(const wire::NumberedMessage& frame) {
    if (newest_) tally_.number_gaps += frame.sequence - newest_->sequence - 1;
    newest_ = frame;
    ++tally_.frames;
    tally_.faulty += frame.message.health.sensor_fault ? 1 : 0;
    tally_.odometer_faulty += frame.message.health.pulses_lost ? 1 : 0;
    tally_.still += frame.message.motion == core::Motion::still ? 1 : 0;
    if (!frame.message.has_rate()) return;
    ++tally_.with_rate;
    compare_sample(frame.message);
    compare_correction(frame.message);
  }

  static bool is_same(const app::RateMessage& message,
                      const std::array<core::AngularRate, 3>& given) {
    for (std::size_t i = 0; i < 3; ++i) {
      const float difference = (message.axes[i].measured - given[i]).in(core::deg_per_s);
      if (std::abs(difference) > 0.51F * kLsbDps) return false;
    }
    return true;
  }

  void compare_sample(const app::RateMessage& message) {
    while (!is_in_step_ && !given_.empty() && !is_same(message, given_.front())) {
      given_.pop_front();
    }
    if (given_.empty()) {
      ++tally_.wrong_samples;
      return;
    }
    is_in_step_ = true;
    tally_.wrong_samples += is_same(message, given_.front()) ? 0 : 1;
    given_.pop_front();
  }

  /// The same step function on the same samples and pulses, in this process.
  void compare_correction(const app::RateMessage& message) {
    while (!pulses_.empty() && pulses_.front() <= message.time) {
      node_.pulse(pulses_.front());
      pulses_.pop_front();
    }
    drivers::GyroSample sample{.time = message.time, .rate = {}, .temperature = {}};
    for (std::size_t i = 0; i < 3; ++i) sample.rate[i] = message.axes[i].measured;
    const app::RateMessage here = node_.step(sample);
    for (std::size_t i = 0; i < 3; ++i) {
      const double difference =
          std::abs((here.axes[i].corrected - message.axes[i].corrected).in(core::deg_per_s));
      tally_.largest_difference_lsb =
          std::max(tally_.largest_difference_lsb, difference / double{kLsbDps});
    }
  }

  linux_node::Node::Params params_;
  linux_node::Node node_;
  std::deque<std::array<core::AngularRate, 3>> given_;
  std::deque<core::Instant> pulses_;
  bool is_in_step_ = false;
  std::optional<wire::NumberedMessage> newest_;
  Tally tally_;
  int socket_ = socket(AF_UNIX, SOCK_DGRAM, 0);
};

}  // namespace zerorate::emulated
