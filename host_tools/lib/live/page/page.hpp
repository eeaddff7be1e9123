/// @file
/// Page for a browser that shows a node while it runs.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "host_tools/lib/live/tally.hpp"

namespace zerorate::live {

/// HTTP server with one page, which needs nothing from any other server. What it shows comes by
/// server-sent events.
///
/// Memory and work are bounded: an hour of history, kMostViewers streams of events, and a few
/// requests at a time; who comes later waits or is told so. A slow browser delays neither show()
/// nor the others. Whoever can reach the address can look; nobody can change anything.
class Page {
 public:
  static constexpr std::size_t kMostViewers = 8;
  static constexpr std::size_t kMostPoints = 3600;  ///< points of the history, one a second

  /// Serves from now on, in threads of its own.
  /// @param address numeric or a name of this machine
  /// @param port  0: one that is free
  /// Throws std::system_error where nothing can listen there.
  Page(const std::string& address, std::uint16_t port);
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;
  /// Ends all streams and waits for the threads: at once, about 4 s where a browser does not take
  /// what it is given.
  ~Page();

  [[nodiscard]] const std::string& url() const { return url_; }

  /// Shows this to all who look. A point of the history is added once a second.
  /// @param silence  since the newest message
  void show(const Tally& tally, const std::string& source, std::chrono::milliseconds silence);

 private:
  class Server;

  std::string url_;
  std::unique_ptr<Server> server_;
};

}  // namespace zerorate::live
