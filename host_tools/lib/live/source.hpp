/// @file
/// Where a node's messages come from: datagrams, serial lines, JSON lines.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/wire/learnt_frame.hpp"
#include "firmware/wire/rate_frame.hpp"
#include "host_tools/lib/live/tally.hpp"

namespace zerorate::live {

/// One receiver, for a loop around poll().
class Source {
 public:
  explicit Source(std::string name) : name_(std::move(name)) {}
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Becomes readable when there is something to receive.
  [[nodiscard]] virtual int descriptor() const = 0;
  /// Takes some of what is there.
  /// @return false at the end: of the file, of the pipe, of a serial adapter that was unplugged
  virtual bool receive(Tally& tally) = 0;

 private:
  std::string name_;
};

// All of them throw std::system_error where the source cannot be opened.

/// Rate frames and those of what was learnt, as UDP datagrams. Throws std::invalid_argument for an
/// address that is none.
[[nodiscard]] std::unique_ptr<Source> listen_udp(const std::string& address, std::uint16_t port);

/// Both kinds of frames on a Unix datagram socket, which is made, and removed at the end
/// (hal::linux_os::NamedSocket). Throws where another program listens there or where the name is
/// not that of a socket.
[[nodiscard]] std::unique_ptr<Source> listen_unix(const std::string& path);

/// Rate and status frames on a serial line, raw, 8N1, framed by COBS.
/// @param baud  one that termios knows, else std::invalid_argument
[[nodiscard]] std::unique_ptr<Source> open_serial(const std::string& device, unsigned baud);

/// JSON lines of a file from its beginning, or of the standard input for "-".
[[nodiscard]] std::unique_ptr<Source> open_json_lines(const std::string& file);

/// Content of a line.
struct JsonMessage {
  wire::NumberedMessage message;
  std::optional<wire::LearntModel> learnt;  ///< in one line a second, once there is something
};

/// The message of a line (docs/reference/zerorated.md); none where it is no such line. A rate that
/// is null comes back as 0, as in a frame, a deviation that is null as infinity.
[[nodiscard]] std::optional<JsonMessage> parse_json_message(std::string_view line);

}  // namespace zerorate::live
