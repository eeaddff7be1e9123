/// @file
/// Where messages go: files, datagrams, CAN. All of them may be there several times.
#pragma once

#include <sys/socket.h>

#include <cerrno>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "firmware/boards/linux/outputs/sink_settings.hpp"
#include "firmware/wire/learnt_frame.hpp"
#include "firmware/wire/rate_frame.hpp"

namespace zerorate::linux_node {

/// A receiver that is absent, slow or broken costs messages, which are counted, never time.
class Sink {
 public:
  explicit Sink(std::string name) : name_(std::move(name)) {}
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;
  virtual ~Sink() = default;

  /// Never blocks for a receiver; no heap.
  void publish(const wire::NumberedMessage& message) {
    if (send(message)) {
      ++sent_;
      error_number_ = 0;
    } else {
      ++dropped_;
    }
  }
  /// Sends what was learnt, where the sink has a place for it. Not counted: it is sent again.
  virtual void publish_learnt(const wire::LearntModel& /*learnt*/) {}
  /// For logs and metrics: "udp:127.0.0.1:4242".
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  /// Reason why the sink takes no messages, as the kernel gave it; 0 after one that it took.
  [[nodiscard]] int error_number() const { return error_number_; }

 protected:
  /// Keeps errno, for a send() or an open() that failed.
  void keep_reason() { keep_reason(errno); }
  void keep_reason(int error_number) { error_number_ = error_number; }

 private:
  virtual bool send(const wire::NumberedMessage& message) = 0;

  std::string name_;
  std::uint64_t sent_ = 0;
  std::uint64_t dropped_ = 0;
  int error_number_ = 0;
};

/// Whether a CAN controller is bus-off after a frame of the kernel.
/// @param can_id  of the frame; others than error frames change nothing
[[nodiscard]] bool is_bus_off_after(std::uint32_t can_id, bool is_bus_off);

/// For logs and metrics: "udp:127.0.0.1:4242".
[[nodiscard]] std::string name_of(const SinkSettings& settings);

/// Throws std::invalid_argument where the sink cannot even be tried: an address that is none. A
/// file's folder, a receiver or a CAN interface that is absent may come later.
/// @param node  name of whose messages they are, where lines tell it; empty: they do not
[[nodiscard]] std::unique_ptr<Sink> make_sink(const SinkSettings& settings,
                                              std::string_view node = {});

}  // namespace zerorate::linux_node
