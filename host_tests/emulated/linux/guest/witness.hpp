/// @file
/// Receives what zerorated publishes and compares it with what the world gave it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/wire/learnt_frame.hpp"
#include "firmware/wire/rate_frame.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/named_socket.hpp"
#include "host_tests/emulated/linux/guest/device_world.hpp"

namespace zerorate::emulated {

inline constexpr float kLsbDps = 8.75e-3F;  // LSM6DSO at 250 deg/s
inline constexpr const char* kRateSocket = "/run/rate.sock";

struct Tally {
  long frames = 0;
  long with_rate = 0;
  long fine = 0;          ///< with a rate, calibrated, and no flag of a fault
  long number_gaps = 0;   ///< messages lost on the way
  long out_of_order = 0;  ///< not the sample that was next
  long never_given = 0;   ///< a rate that the gyro has not measured lately
  long faulty = 0;        ///< messages with sensor_fault
  long odometer_faulty = 0;
  long inconsistent = 0;
  long still = 0;
  double largest_difference_lsb = 0.0;  ///< from the node that runs beside, corrected rate
};

class Witness {
 public:
  /// @param lsb_dps  of the gyro
  Witness(const linux_node::Configuration& configuration, float lsb_dps)
      : lsb_dps_(lsb_dps), params_(configuration.node), node_(params_) {
    const auto address = hal::linux_os::unix_address(kRateSocket);
    (void)unlink(kRateSocket);
    if (bind(socket_.get(), address.get(), address.size) != 0) give_up(kRateSocket);
  }

  /// Notes a rate that the world gave; in order.
  void expect(const std::array<core::AngularRate, 3>& rate) {
    given_.push_back(rate);
    lately_.push_back(rate);
    constexpr std::size_t kLately = 2048;
    if (lately_.size() > kLately) lately_.pop_front();
  }
  void pulsed(core::Instant at) {
    pulses_.push_back(at);
    pulses_given_.push_back(at);
  }
  /// After a fault: the next sample may be any of those given from now on.
  void forget_given() {
    given_.clear();
    is_in_step_ = false;
  }
  /// zerorated begins to count anew.
  void expect_restart() { newest_.reset(); }

  void receive() {
    std::array<std::uint8_t, wire::kMostRateFrameBytes> bytes{};
    for (;;) {
      const ssize_t size = recv(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (size < 0) return;
      const auto datagram = std::span{bytes}.first(static_cast<std::size_t>(size));
      if (wire::decode_learnt_frame(datagram)) continue;
      const auto frame = wire::decode_rate_frame(datagram);
      if (!frame) give_up("a datagram that is no frame");
      take(*frame);
    }
  }

  [[nodiscard]] const Tally& tally() const { return tally_; }
  [[nodiscard]] const std::optional<wire::NumberedMessage>& newest() const { return newest_; }
  /// All messages, in order.
  [[nodiscard]] const std::vector<wire::NumberedMessage>& published() const { return published_; }
  [[nodiscard]] const std::vector<core::Instant>& pulses_given() const { return pulses_given_; }

 private:
  using Rates = std::array<core::AngularRate, 3>;

  void take(const wire::NumberedMessage& frame) {
    if (newest_) tally_.number_gaps += static_cast<long>(frame.sequence - newest_->sequence - 1);
    newest_ = frame;
    published_.push_back(frame);
    const app::Health& health = frame.message.health;
    ++tally_.frames;
    tally_.faulty += health.sensor_fault ? 1 : 0;
    tally_.odometer_faulty += health.odometer_fault ? 1 : 0;
    tally_.inconsistent += health.model_inconsistent ? 1 : 0;
    tally_.still += frame.message.motion == core::Motion::still ? 1 : 0;
    if (!frame.message.has_rate()) return;
    ++tally_.with_rate;
    tally_.fine += health == app::Health{.calibrated = true} ? 1 : 0;
    compare_sample(frame.message);
    compare_correction(frame.message);
  }

  [[nodiscard]] bool is_same(const app::RateMessage& message, const Rates& given) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const float difference = (message.axes[i].measured - given[i]).in(core::deg_per_s);
      if (std::abs(difference) > 0.51F * lsb_dps_) return false;
    }
    return true;
  }

  void compare_sample(const app::RateMessage& message) {
    const auto is_it = [&](const Rates& given) { return is_same(message, given); };
    tally_.never_given += std::ranges::any_of(lately_, is_it) ? 0 : 1;
    while (!is_in_step_ && !given_.empty() && !is_it(given_.front())) given_.pop_front();
    if (given_.empty()) {
      ++tally_.out_of_order;
      return;
    }
    is_in_step_ = true;
    tally_.out_of_order += is_it(given_.front()) ? 0 : 1;
    given_.pop_front();
  }

  /// Compares with the step function run on equal samples and pulses in this process.
  void compare_correction(const app::RateMessage& message) {
    while (!pulses_.empty() && pulses_.front() <= message.time) {
      node_.pulse(pulses_.front());
      pulses_.pop_front();
    }
    core::GyroSample sample{.time = message.time, .rate = {}, .temperature = {}};
    for (std::size_t i = 0; i < 3; ++i) sample.rate[i] = message.axes[i].measured;
    const app::RateMessage here = node_.step(sample);
    for (std::size_t i = 0; i < 3; ++i) {
      const double difference =
          std::abs((here.axes[i].corrected - message.axes[i].corrected).in(core::deg_per_s));
      tally_.largest_difference_lsb =
          std::max(tally_.largest_difference_lsb, difference / double{lsb_dps_});
    }
  }

  float lsb_dps_;
  linux_node::Node::Params params_;
  linux_node::Node node_;
  std::deque<Rates> given_;
  std::deque<Rates> lately_;
  std::deque<core::Instant> pulses_;
  std::vector<core::Instant> pulses_given_;
  bool is_in_step_ = false;
  std::optional<wire::NumberedMessage> newest_;
  std::vector<wire::NumberedMessage> published_;
  Tally tally_;
  hal::linux_os::Descriptor socket_{socket(AF_UNIX, SOCK_DGRAM, 0)};
};

}  // namespace zerorate::emulated
