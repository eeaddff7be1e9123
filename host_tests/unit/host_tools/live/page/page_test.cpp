/// @file
/// Page for browsers of zerorate monitor.

#include "host_tools/lib/live/page/page.hpp"

#include <gtest/gtest.h>
#include <httplib.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include "firmware/wire/health_bits.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/named_socket.hpp"
#include "host_tests/unit/firmware/wire/messages.hpp"
#include "host_tests/unit/host_tools/live/messages.hpp"
#include "host_tools/lib/live/page/page_json.hpp"

namespace zerorate::live {
namespace {

using std::chrono::milliseconds;
using testing::calibrated_message;
using testing::tally_of;

/// A browser as the server sees it: takes events until it has had enough.
class Viewer {
 public:
  Viewer(const Page& page, std::size_t enough) {
    thread_ = std::thread{[url = page.url(), enough, this] {
      httplib::Client client{url.substr(0, url.size() - 1)};
      client.set_read_timeout(std::chrono::seconds{10});
      const auto answer = client.Get("/events", [&](const char* data, std::size_t size) {
        text_.append(data, size);
        const bool goes_on = events().size() < enough;
        is_fed_ = true;
        return goes_on;
      });
      if (answer) status_ = answer->status;
    }};
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  ~Viewer() {
    if (thread_.joinable()) thread_.join();
  }

  [[nodiscard]] bool is_fed() const { return is_fed_; }
  void wait_until_fed() const {
    while (!is_fed_) std::this_thread::sleep_for(milliseconds{1});
  }
  std::vector<nlohmann::json> take() {
    thread_.join();
    return events();
  }
  /// After take().
  [[nodiscard]] int status() const { return status_; }

 private:
  [[nodiscard]] std::vector<nlohmann::json> events() const {
    std::vector<nlohmann::json> events;
    std::istringstream lines{text_};
    for (std::string line; std::getline(lines, line) && !lines.eof();) {
      if (line.starts_with("data: ")) events.push_back(nlohmann::json::parse(line.substr(6)));
    }
    return events;
  }

  std::string text_;
  std::atomic<bool> is_fed_ = false;
  int status_ = 0;
  std::thread thread_;
};

TEST(PageOfANode, TellsAViewerTheHistoryFirstAndThenOnlyWhatIsNew) {
  Page page{"127.0.0.1", 0};
  Tally tally = tally_of(calibrated_message(7));
  tally.learnt = wire::testing::some_learnt_model();
  page.show(tally, "udp \"x\"", milliseconds{10});
  Viewer viewer{page, 2};
  viewer.wait_until_fed();
  page.show(tally, "udp \"x\"", milliseconds{3100});
  const auto events = viewer.take();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_TRUE(events[0]["anew"]);
  ASSERT_EQ(events[0]["points"].size(), 1U);
  EXPECT_EQ(events[0]["points"][0].size(), 8U);
  EXPECT_FLOAT_EQ(events[0]["points"][0][5], 0.5F);
  EXPECT_EQ(events[0]["points"][0][7], 1) << "at rest";
  const auto& now = events[0]["now"];
  EXPECT_EQ(now["source"], "udp \"x\"");
  EXPECT_EQ(now["motion"], "still");
  EXPECT_EQ(now["stops"], 1);
  EXPECT_TRUE(now["silent_s"].is_null());
  EXPECT_TRUE(now["wrong"].empty());
  EXPECT_FLOAT_EQ(now["axes"][2]["rate_dps"], -0.25F);
  EXPECT_FLOAT_EQ(now["axes"][2]["bias_dps"], 0.5F);
  EXPECT_NEAR(now["axes"][2]["half95_dps"], 7.06 / 3600.0, 0.01 / 3600.0);
  EXPECT_FLOAT_EQ(now["learnt"]["bias_instability_dph"][0], 12.0F);
  EXPECT_FALSE(events[1]["anew"]);
  EXPECT_TRUE(events[1]["points"].empty()) << "a point a second";
  EXPECT_EQ(events[1]["now"]["silent_s"], 3);
  EXPECT_TRUE(events[1]["now"]["axes"][2]["rate_dps"].is_null());
}

/// A page of another origin whose name leads to this machine, by a trick of its name server.
TEST(PageOfANode, HasAttitudeVibrationAndSharesOfTheBias) {
  auto message = calibrated_message(1);
  const auto none = now_json(tally_of(message), "x", milliseconds{0});
  EXPECT_TRUE(none["attitude"].is_null() && none["vibration_g"].is_null());
  EXPECT_TRUE(none["explained"].is_null());
  message.message.up = core::Direction{-1.0F, 0.0F, 0.0F};
  message.message.vibration = core::standard_gravity(0.25F);
  message.message.explained.emplace()[2].vibration = core::deg_per_s(0.5F);
  const auto now = now_json(tally_of(message), "x", milliseconds{0});
  EXPECT_NEAR(now["attitude"]["pitch_deg"].get<double>(), 90.0, 1e-3);
  EXPECT_NEAR(now["attitude"]["tilt_deg"].get<double>(), 90.0, 1e-3);
  EXPECT_NEAR(now["vibration_g"].get<double>(), 0.25, 1e-6);
  EXPECT_EQ(now["explained"][2]["input"], "vibration");
  EXPECT_NEAR(now["explained"][2]["rate_dps"][2].get<double>(), 0.5, 1e-6);
  const auto old = now_json(tally_of(message), "x", milliseconds{3000});
  EXPECT_TRUE(old["attitude"].is_null() && old["explained"].is_null());
}

TEST(PageOfANode, IsReadByItsOwnNamesAndByNoOtherPage) {
  const Page page{"127.0.0.1", 0};
  const std::string url = page.url().substr(0, page.url().size() - 1);
  const std::string port = url.substr(url.rfind(':'));
  const auto status_of = [&](const httplib::Headers& headers) {
    httplib::Client client{url};
    const auto answer = client.Get("/", headers);
    return answer ? answer->status : 0;
  };
  EXPECT_EQ(status_of({{"Host", "localhost" + port}}), 200);
  EXPECT_EQ(status_of({{"Host", "127.0.0.1" + port}}), 200);
  EXPECT_EQ(status_of({{"Host", "[::1]" + port}}), 200);
  EXPECT_EQ(status_of({{"Host", "evil.example" + port}}), 403);
  EXPECT_EQ(status_of({{"Host", "localhost" + port}, {"Origin", "http://localhost" + port}}), 200);
  EXPECT_EQ(status_of({{"Host", "localhost" + port}, {"Origin", "http://evil.example"}}), 403);
}

TEST(PageOfANode, ShowsANameThatIsNoUtf8) {
  Page page{"127.0.0.1", 0};
  page.show(tally_of(calibrated_message(7)), "json \xFF\xFE", milliseconds{10});
  Viewer viewer{page, 1};
  EXPECT_EQ(viewer.take().size(), 1U);
}

TEST(PageOfANode, HasWordsForEveryFlagAndLoadsNothingFromElsewhere) {
  const Page page{"127.0.0.1", 0};
  httplib::Client client{page.url().substr(0, page.url().size() - 1)};
  const auto answer = client.Get("/");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  for (const wire::HealthBit& bit : wire::kHealthBits) {
    EXPECT_NE(answer->body.find("\n  " + std::string{bit.name} + ": ["), std::string::npos)
        << bit.name;
  }
  EXPECT_NE(answer->body.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(client.Get("/etc/passwd")->status, 404);
  EXPECT_EQ(client.Post("/", "x", "text/plain")->status, 413) << "nothing can be changed";
}

TEST(PageOfANode, TellsOneViewerTooManySoAndServesTheOthers) {
  Page page{"127.0.0.1", 0};
  page.show({}, "x", milliseconds{0});
  std::deque<Viewer> viewers;
  for (std::size_t i = 0; i < Page::kMostViewers; ++i) {
    viewers.emplace_back(page, 2);
    viewers.back().wait_until_fed();
  }
  httplib::Client client{page.url().substr(0, page.url().size() - 1)};
  const auto refusal = client.Get("/events");
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->status, 503);
  EXPECT_EQ(client.Get("/")->status, 200);
  page.show({}, "x", milliseconds{0});
  for (Viewer& viewer : viewers) EXPECT_EQ(viewer.take().size(), 2U);
}

TEST(PageOfANode, EndsWhileSomebodyLooks) {
  auto page = std::make_unique<Page>("127.0.0.1", std::uint16_t{0});
  page->show({}, "x", milliseconds{0});
  Viewer viewer{*page, 1000};
  viewer.wait_until_fed();
  const auto begin = std::chrono::steady_clock::now();
  page.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds{5});
  EXPECT_EQ(viewer.take().size(), 1U);
}

void connect_to(const Page& page, const hal::linux_os::Descriptor& socket) {
  const std::string& url = page.url();
  const auto port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
  const hal::linux_os::SocketAddress address = hal::linux_os::udp_address("127.0.0.1", port);
  EXPECT_EQ(connect(socket.get(), address.get(), address.size), 0);
}

hal::linux_os::Descriptor stream_socket() {
  return hal::linux_os::checked_descriptor(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0),
                                           "socket");
}

/// A client that never ends its question.
class Dribbler {
 public:
  explicit Dribbler(const Page& page) {
    connect_to(page, socket_);
    say("GET / HTTP/1.1\r\nX: ");
  }
  /// @return whether the connection is still open
  bool say(std::string_view words) const {
    return send(socket_.get(), words.data(), words.size(), MSG_NOSIGNAL) >= 0;
  }

 private:
  hal::linux_os::Descriptor socket_ = stream_socket();
};

TEST(PageOfANode, IsNotHeldUpByClientsThatDoNotEndTheirQuestions) {
  const Page page{"127.0.0.1", 0};
  std::deque<Dribbler> dribblers;
  for (int i = 0; i < 24; ++i) dribblers.emplace_back(page);
  std::atomic<bool> is_over = false;
  std::thread dribbling{[&] {
    while (!is_over) {
      for (const Dribbler& dribbler : dribblers) (void)dribbler.say("a");
      std::this_thread::sleep_for(milliseconds{100});
    }
  }};
  const auto begin = std::chrono::steady_clock::now();
  httplib::Client client{page.url().substr(0, page.url().size() - 1)};
  client.set_read_timeout(std::chrono::seconds{10});
  const auto answer = client.Get("/");
  is_over = true;
  dribbling.join();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds{5});
}

/// A browser that takes the beginning of an event and then nothing more.
class Sleeper {
 public:
  explicit Sleeper(const Page& page) {
    const int few_bytes = 1024;
    EXPECT_EQ(setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &few_bytes, sizeof few_bytes), 0);
    connect_to(page, socket_);
    constexpr std::string_view kRequest = "GET /events HTTP/1.1\r\nHost: x\r\n\r\n";
    EXPECT_EQ(send(socket_.get(), kRequest.data(), kRequest.size(), 0),
              static_cast<ssize_t>(kRequest.size()));
    std::array<char, 256> bytes{};
    for (std::string begun; begun.find("data: ") == std::string::npos;) {
      const ssize_t size = recv(socket_.get(), bytes.data(), bytes.size(), 0);
      if (size <= 0) throw std::runtime_error("no event came");
      begun.append(bytes.data(), static_cast<std::size_t>(size));
    }
  }

 private:
  hal::linux_os::Descriptor socket_ = stream_socket();
};

TEST(PageOfANode, IsNotHeldUpByASlowViewer) {
  auto page = std::make_unique<Page>("127.0.0.1", std::uint16_t{0});
  // More than the kernel keeps for a socket, so that a write has to wait.
  const std::string long_name(8U << 20U, 'x');
  page->show({}, long_name, milliseconds{0});
  const Sleeper sleeper{*page};
  page->show({}, "x", milliseconds{0});
  Viewer viewer{*page, 2};
  viewer.wait_until_fed();
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 100; ++i) page->show({}, "x", milliseconds{0});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds{500});
  EXPECT_EQ(viewer.take().size(), 2U);
  const auto end = std::chrono::steady_clock::now();
  page.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - end, std::chrono::seconds{6});
}

TEST(AddressOfAPage, IsThatOfThisMachineAloneOrNot) {
  using hal::linux_os::is_loopback;
  for (const auto* const own : {"127.0.0.1", "127.255.0.9", "::1", "localhost"}) {
    EXPECT_TRUE(is_loopback(own)) << own;
  }
  for (const auto* const open : {"0.0.0.0", "::", "192.168.1.5", "128.0.0.1", "fe80::1", "",
                                 "[::1]", "127.0.0.1.example", "localhost.example", "127.1"}) {
    EXPECT_FALSE(is_loopback(open)) << open;
  }
}

TEST(PageOfANode, DoesNotShareThePortOfAnother) {
  const Page first{"127.0.0.1", 0};
  const std::string& url = first.url();
  const std::size_t colon = url.rfind(':');
  const auto port = static_cast<std::uint16_t>(std::stoi(url.substr(colon + 1)));
  EXPECT_THROW((Page{"127.0.0.1", port}), std::system_error);
  EXPECT_THROW((Page{"no address", 0}), std::system_error);
}

}  // namespace
}  // namespace zerorate::live
