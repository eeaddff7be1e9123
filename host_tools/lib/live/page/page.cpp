#include "host_tools/lib/live/page/page.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <semaphore>
#include <system_error>
#include <thread>
#include <utility>

#include "host_tools/lib/live/page/page_json.hpp"
#include "host_tools/lib/report/web_assets.hpp"

namespace zerorate::live {
namespace {

using nlohmann::json;
using std::chrono::seconds;

/// Requests at a time: the streams, and a few that fetch the page.
constexpr std::size_t kWorkers = Page::kMostViewers + 4;
constexpr seconds kPatience{2};  // with a browser that does not take what it is given
/// Patience with a question, from the connection to its end. Browsers send it at once.
constexpr std::chrono::milliseconds kPatienceWithQuestions{1000};

/// Forbids every load from elsewhere.
constexpr std::string_view kContentPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; "
    "connect-src 'self'";

std::string page_html() {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n"
      "<title>zerorate monitor</title>\n<style>{}\n{}\n{}</style>\n"
      "<script>/* uPlot\n{}\n*/\n{}</script>\n{}<script>{}</script>\n</html>\n",
      kContentPolicy, report::kPlotStyle, report::kReportStyle, report::kLiveStyle,
      report::kPlotLicence, report::kPlotScript, report::kLivePage, report::kLiveScript);
}

/// Name of a host without its port.
std::string_view without_port(std::string_view host) {
  if (host.starts_with('[')) return host.substr(1, host.find(']') - 1);
  return host.substr(0, host.find(':'));
}

bool is_address(const std::string& name) {
  std::array<std::uint8_t, sizeof(in6_addr)> address{};
  return inet_pton(AF_INET, name.c_str(), address.data()) == 1 ||
         inet_pton(AF_INET6, name.c_str(), address.data()) == 1;
}

/// Whether no public name server can have given the name: it has no dot, or is this machine's.
bool is_own_name(std::string_view name) {
  if (!name.empty() && name.find('.') == std::string_view::npos) return true;
  std::array<char, 256> own{};
  (void)gethostname(own.data(), own.size() - 1);
  const std::string_view host{own.data()};
  return !host.empty() && name.starts_with(host) &&
         (name.size() == host.size() || name[host.size()] == '.');
}

/// Whether a request was meant for this program: by an address or a name of this machine, and from
/// no page of another origin. A foreign page whose name leads here would read the rates otherwise.
bool is_for_this_machine(const httplib::Request& request) {
  const std::string host = request.get_header_value("Host");
  const std::string origin = request.get_header_value("Origin");
  const std::string name{without_port(host)};
  return (is_address(name) || is_own_name(name)) && (origin.empty() || origin == "http://" + host);
}

/// Threads of the server. A request for which none is free waits in the kernel's queue, which is
/// bounded, and not in this program.
class Workers final : public httplib::ThreadPool {
 public:
  Workers() : ThreadPool(kWorkers) {}

  void enqueue(std::function<void()> work) override {
    free_.acquire();
    ThreadPool::enqueue([this, work = std::move(work)] {
      work();
      free_.release();
    });
  }

 private:
  std::counting_semaphore<kWorkers> free_{kWorkers};
};

/// Connection to a client, whose question ends in time or is not answered. The limits of httplib
/// hold for each byte, so that a client which sends one now and then would keep its thread for
/// ever.
class Connection final : public httplib::Stream {
 public:
  explicit Connection(int socket) : socket_(socket) {}

  bool is_readable() const override {
    return waits(POLLIN, std::chrono::ceil<std::chrono::milliseconds>(
                             ends_at_ - std::chrono::steady_clock::now()));
  }
  bool is_writable() const override { return waits(POLLOUT, kPatience); }
  ssize_t read(char* bytes, std::size_t size) override {
    return is_readable() ? recv(socket_, bytes, size, 0) : -1;
  }
  ssize_t write(const char* bytes, std::size_t size) override {
    return is_writable() ? send(socket_, bytes, size, MSG_NOSIGNAL) : -1;
  }
  void get_remote_ip_and_port(std::string& /*address*/, int& /*port*/) const override {}
  void get_local_ip_and_port(std::string& /*address*/, int& /*port*/) const override {}
  socket_t socket() const override { return socket_; }

 private:
  /// @return whether the socket is ready before the time is over
  bool waits(short events, std::chrono::milliseconds time) const {
    pollfd ready{.fd = socket_, .events = events, .revents = 0};
    return time.count() > 0 && poll(&ready, 1, static_cast<int>(time.count())) == 1;
  }

  int socket_;
  std::chrono::steady_clock::time_point ends_at_ =
      std::chrono::steady_clock::now() + kPatienceWithQuestions;
};

/// Names may be no UTF-8: what is none is replaced.
std::string as_text(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace

class Page::Server {
 public:
  Server(const std::string& address, std::uint16_t port) {
    http_.new_task_queue = [] { return new Workers; };  // owned by the server
    http_.set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
      if (is_for_this_machine(request)) return httplib::Server::HandlerResponse::Unhandled;
      response.status = 403;
      response.set_content("not by this name: open the page by its address\n", "text/plain");
      return httplib::Server::HandlerResponse::Handled;
    });
    http_.set_write_timeout(kPatience);
    http_.set_payload_max_length(0);
    // Not SO_REUSEPORT, with which two programs would share a port without knowing.
    http_.set_socket_options([](int socket) {
      const int yes = 1;
      (void)setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    http_.Get("/", [html = page_html()](const httplib::Request&, httplib::Response& response) {
      response.set_content(html, "text/html; charset=utf-8");
    });
    http_.Get("/events", [this](const httplib::Request&, httplib::Response& response) {
      start_stream(response);
    });
    errno = 0;
    port_ = port == 0 ? http_.bind_to_any_port(address)
                      : (http_.bind_to_port(address, port) ? int{port} : -1);
    if (port_ < 0) {
      throw std::system_error(
          errno != 0 ? errno : EADDRNOTAVAIL, std::generic_category(),
          fmt::format("no page at {}, port {} (port 0 takes one that is free)", address, port));
    }
    thread_ = std::thread{[this] {
      (void)http_.listen_after_bind();
      has_ended_ = true;
    }};
    // Until then the server cannot be stopped.
    while (!http_.is_running() && !has_ended_) std::this_thread::yield();
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server() {
    {
      const std::lock_guard lock{mutex_};
      is_ending_ = true;
    }
    changed_.notify_all();
    http_.stop();
    thread_.join();
  }

  [[nodiscard]] int port() const { return port_; }

  void show(json now) {
    {
      const std::lock_guard lock{mutex_};
      const auto at = std::chrono::steady_clock::now();
      if (points_ == 0 || at - newest_point_at_ >= seconds{1}) {
        newest_point_at_ = at;
        history_.push_back(point_json(now));
        ++points_;
        if (history_.size() > kMostPoints) history_.pop_front();
      }
      now_ = std::move(now);
      ++version_;
    }
    changed_.notify_all();
  }

 private:
  /// A server of one question a connection.
  class Http final : public httplib::Server {
   private:
    bool process_and_close_socket(socket_t socket) override {
      Connection connection{socket};
      bool is_closed = false;
      const bool is_answered = process_request(connection, true, is_closed, nullptr);
      (void)shutdown(socket, SHUT_RDWR);
      (void)close(socket);
      return is_answered;
    }
  };

  /// Events sent to a browser.
  struct Viewer {
    std::uint64_t version = 0;
    std::uint64_t points = 0;
  };

  void start_stream(httplib::Response& response) {
    if (viewers_.fetch_add(1) >= kMostViewers) {
      --viewers_;
      response.status = 503;
      response.set_content("too many pages are open\n", "text/plain");
      return;
    }
    response.set_header("Cache-Control", "no-store");
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, viewer = Viewer{}](std::size_t /*offset*/, httplib::DataSink& sink) mutable {
          return feed(viewer, sink);
        },
        [this](bool /*success*/) { --viewers_; });
  }

  /// Waits for news and sends it.
  /// @return false where nobody takes it
  bool feed(Viewer& viewer, httplib::DataSink& sink) {
    // Tells the page that the program lives, and this program whether somebody is there.
    std::string text = "event: alive\ndata: 1\n\n";
    {
      std::unique_lock lock{mutex_};
      changed_.wait_for(lock, seconds{1}, [&] { return is_ending_ || version_ != viewer.version; });
      if (is_ending_) {
        sink.done();
        return true;
      }
      if (version_ != viewer.version) text = "data: " + as_text(news(viewer)) + "\n\n";
    }
    return sink.write(text.data(), text.size());
  }

  /// The moment, and the points that this viewer has not seen; the first time the whole history.
  json news(Viewer& viewer) const {
    json message{{"anew", viewer.version == 0}, {"now", now_}, {"points", json::array()}};
    const std::uint64_t first = points_ - history_.size();
    for (std::uint64_t i = std::max(first, viewer.points); i < points_; ++i) {
      message["points"].push_back(history_[i - first]);
    }
    viewer = {.version = version_, .points = points_};
    return message;
  }

  Http http_;
  int port_ = -1;
  std::atomic<std::size_t> viewers_ = 0;
  std::atomic<bool> has_ended_ = false;

  std::mutex mutex_;  // protects all members below
  std::condition_variable changed_;
  bool is_ending_ = false;
  json now_;
  std::uint64_t version_ = 0;
  std::deque<json> history_;
  std::uint64_t points_ = 0;  ///< points of the history since the start
  std::chrono::steady_clock::time_point newest_point_at_;

  std::thread thread_;
};

Page::Page(const std::string& address, std::uint16_t port)
    : server_(std::make_unique<Server>(address, port)) {
  const bool is_ipv6 = address.find(':') != std::string::npos;
  url_ = fmt::format("http://{}{}{}:{}/", is_ipv6 ? "[" : "", address, is_ipv6 ? "]" : "",
                     server_->port());
}

Page::~Page() = default;

void Page::show(const Tally& tally, const std::string& source, std::chrono::milliseconds silence) {
  server_->show(now_json(tally, source, silence));
}

}  // namespace zerorate::live
