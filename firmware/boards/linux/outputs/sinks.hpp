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
  /// @param every  takes the first of so many messages; the others are not counted
  explicit Sink(std::string name, std::uint32_t every = 1)
      : name_(std::move(name)), every_(every) {}
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;
  virtual ~Sink() = default;

  /// Never blocks for a receiver; no heap.
  void publish(const wire::NumberedMessage& message) {
    const bool is_due = offered_ == 0;
    offered_ = (offered_ + 1) % every_;
    if (!is_due) return;
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
  std::uint32_t every_;
  std::uint32_t offered_ = 0;  ///< since the last one that was due
  std::uint64_t sent_ = 0;
  std::uint64_t dropped_ = 0;
  int error_number_ = 0;
};

/// For logs and metrics: "udp:127.0.0.1:4242".
[[nodiscard]] std::string name_of(const SinkSettings& settings);

/// Throws std::invalid_argument where the sink cannot even be tried: an address that is none. A
/// file's folder, a receiver or a CAN interface that is absent may come later.
/// @param node  name of whose messages they are, where lines tell it; empty: they do not
[[nodiscard]] std::unique_ptr<Sink> make_sink(const SinkSettings& settings,
                                              std::string_view node = {});

}  // namespace zerorate::linux_node
