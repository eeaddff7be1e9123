/// @file
/// What the service counts, as text that Prometheus and people read.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/event.hpp"
#include "firmware/boards/linux/node_service.hpp"
#include "hal/linux/named_socket.hpp"

namespace zerorate::linux_node {

using MetricsBuffer = std::array<char, 16384>;

/// The Prometheus text format, version 0.0.4. No heap.
[[nodiscard]] std::string_view format_metrics(const NodeService& service, MetricsBuffer& buffer);

/// The text in a file, replaced as a whole, and on a Unix socket that gives it to whoever connects.
class MetricsEndpoint {
 public:
  /// Throws std::system_error where the socket cannot be made.
  explicit MetricsEndpoint(const MetricsSettings& settings);
  MetricsEndpoint(const MetricsEndpoint&) = delete;
  MetricsEndpoint& operator=(const MetricsEndpoint&) = delete;

  /// Replaces the text; a file that cannot be written keeps the old one.
  void update(const NodeService& service);
  /// Readable when somebody asks; -1 without a socket.
  [[nodiscard]] int descriptor() const { return listener_ ? listener_->descriptor() : -1; }
  /// Gives the text to everybody who waits. A reader that does not take it all at once loses the
  /// rest: nobody is waited for.
  void serve() const;

 private:
  MetricsSettings settings_;
  std::string file_while_written_;
  std::optional<hal::linux_os::NamedSocket> listener_;
  MetricsBuffer buffer_{};
  std::string_view text_;
};

}  // namespace zerorate::linux_node
