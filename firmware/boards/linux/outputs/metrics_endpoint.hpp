/// @file
/// Where the text of the metrics is read.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "hal/linux/named_socket.hpp"

namespace zerorate::linux_node {

struct MetricsSettings {
  std::string file;    ///< written once a second; empty: not
  std::string socket;  ///< each connection is given the text; empty: none
};

/// A text in a file, replaced as a whole, and on a Unix socket that gives it to whoever connects.
/// No heap once it is made.
class MetricsEndpoint {
 public:
  /// Throws std::system_error where the socket cannot be made.
  explicit MetricsEndpoint(const MetricsSettings& settings);

  [[nodiscard]] bool is_wanted() const { return !settings_.file.empty() || listener_; }
  /// Replaces the text; a file that cannot be written keeps the old one, and error_number() says
  /// why.
  /// @param text  must stay as it is until the next call
  void publish(std::string_view text);
  /// Reason why the file was not written the last time; 0: it was.
  [[nodiscard]] int error_number() const { return error_number_; }
  /// Readable when somebody asks; -1 without a socket.
  [[nodiscard]] int descriptor() const { return listener_ ? listener_->descriptor() : -1; }
  /// Gives the text to everybody who waits. A reader that does not take it all at once loses the
  /// rest: nobody is waited for.
  void serve() const;

 private:
  [[nodiscard]] int write_file() const;

  MetricsSettings settings_;
  std::string file_while_written_;
  std::optional<hal::linux_os::NamedSocket> listener_;
  std::string_view text_;
  int error_number_ = 0;
};

}  // namespace zerorate::linux_node
