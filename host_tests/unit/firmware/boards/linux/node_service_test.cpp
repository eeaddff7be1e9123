#include "firmware/boards/linux/node_service.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "firmware/boards/linux/metrics_text.hpp"
#include "host_tests/unit/firmware/boards/linux/service_rig.hpp"

namespace zerorate::linux_node {
namespace {

using hal::testing::Fault;

/// A receiver of datagrams on a Unix socket.
class Receiver {
 public:
  explicit Receiver(const std::filesystem::path& path)
      : socket_(checked_descriptor(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0), "socket")) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::ranges::copy(path.string(), std::begin(address.sun_path));
    EXPECT_EQ(bind(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  std::vector<wire::NumberedMessage> take() {
    std::vector<wire::NumberedMessage> messages;
    std::array<std::uint8_t, 256> bytes{};
    for (;;) {
      const ssize_t size = recv(socket_.get(), bytes.data(), bytes.size(), 0);
      if (size < 0) return messages;
      const auto datagram = std::span{bytes}.first(static_cast<std::size_t>(size));
      if (const auto model = wire::decode_learnt_frame(datagram)) {
        learnt.push_back(*model);
        continue;
      }
      const auto message = wire::decode_rate_frame(datagram);
      EXPECT_TRUE(message);
      if (message) messages.push_back(*message);
    }
  }

  std::vector<wire::LearntModel> learnt;  ///< taken on the way

 private:
  Descriptor socket_;
};

TEST(NodeServiceWithReferences, CountsThemAndSaysWhatTheyTaught) {
  ServiceRig rig;
  rig.configuration.reference = ReferenceSettings{.origin = UnixSettings{"x"}};
  rig.restart(kBoot);
  const auto refer = [&](float heading_deg) {
    rig.hardware.reference = app::HeadingReference{
        .time = rig.hardware.now(), .heading = core::deg(heading_deg), .sigma = core::deg(0.5F)};
  };
  refer(10.0F);
  rig.run(104);
  rig.run(20 * 104);
  EXPECT_EQ(rig.service->status().references.unusable, 1U) << "no bias yet";
  refer(10.0F);
  rig.run(2 * 104);
  ASSERT_TRUE(core::is_finite(rig.service->status().heading.sigma.in(core::deg)));
  EXPECT_NEAR(rig.service->status().heading.angle.in(core::deg), 10.0F, 0.1F);
  MetricsBuffer buffer{};
  const std::string metrics{format_metrics(*rig.service, buffer)};
  EXPECT_NE(metrics.find("zerorate_references_unusable_total 1\n"), std::string::npos);
  EXPECT_NE(metrics.find("zerorate_heading_deg 10\n"), std::string::npos);
  EXPECT_NE(metrics.find("zerorate_scale_factor_sigma_percent 1\n"), std::string::npos);
}

TEST(MetricsOfANode, HaveItsAttitudeAndWhatTheInputsExplain) {
  ServiceRig rig;
  rig.configuration.node.up = core::UpAxis{.axis = 0};
  rig.configuration.node.model.inputs.terms[0] = {.input = core::Input::temperature,
                                                  .sigma = 1e-5F};
  rig.restart(kBoot);
  rig.run(20 * 104);
  MetricsBuffer buffer{};
  const std::string metrics{format_metrics(*rig.service, buffer)};
  EXPECT_NE(metrics.find("zerorate_tilt_deg 90"), std::string::npos);
  EXPECT_NE(metrics.find("zerorate_pitch_deg -90"), std::string::npos);
  EXPECT_NE(metrics.find("zerorate_explained_temperature_dps{axis=\"z\"} "), std::string::npos);
}

TEST(NodeServiceOnHealthyHardware, PublishesToEverySink) {
  ServiceRig rig;
  Receiver receiver{rig.folder.path() / "rate"};
  std::vector<wire::NumberedMessage> received;
  for (int i = 0; i < 1040; ++i) {
    rig.run(1);
    for (const auto& message : receiver.take()) received.push_back(message);
  }
  ASSERT_GT(received.size(), 1000U);
  for (std::size_t i = 1; i < received.size(); ++i) {
    EXPECT_EQ(received[i].sequence, received[i - 1].sequence + 1);
  }
  const app::RateMessage& last = received.back().message;
  EXPECT_TRUE(last.health.calibrated);
  EXPECT_EQ(last.motion, core::Motion::still);
  EXPECT_NEAR(last.axes[0].bias.in(core::deg_per_s), 0.35F, 1e-3F);

  std::ifstream file{rig.folder.path() / "rate.jsonl"};
  std::size_t lines = 0;
  for (std::string line; std::getline(file, line); ++lines) {
    const auto json = nlohmann::json::parse(line);
    EXPECT_EQ(json["sequence"], received.at(lines).sequence);
    EXPECT_EQ(json["rate_dps"][2].get<float>(),
              received[lines].message.axes[2].corrected.in(core::deg_per_s));
  }
  EXPECT_EQ(lines, received.size());
  EXPECT_EQ(rig.service->sinks()[0]->sent(), received.size());
  EXPECT_TRUE(was_logged(" started, 104 Hz, 250 deg/s"));
}

TEST(NodeServiceThatHasLearntFromAStop, SendsItEachSecond) {
  ServiceRig rig;
  Receiver receiver{rig.folder.path() / "rate"};
  for (int i = 0; i < 30 * 104; ++i) {
    rig.run(1);
    (void)receiver.take();  // the queue of a Unix socket is short
  }
  ASSERT_GE(receiver.learnt.size(), 25U) << "once a second from the first stop on";
  ASSERT_LE(receiver.learnt.size(), 30U);
  const wire::LearntModel& newest = receiver.learnt.back();
  EXPECT_EQ(newest, rig.service->status().learnt);
  EXPECT_TRUE(newest.is_learnt());
  for (const app::LearntNoise& axis : newest.axes) {
    EXPECT_GT(axis.order.value, 0.3F);
    EXPECT_LT(axis.order.value, 0.95F);
    EXPECT_GT(axis.bias_instability_rad_s.value, 0.0F);
    EXPECT_GT(axis.angle_random_walk_rad_per_sqrt_s.value, 0.0F);
  }

  std::ifstream file{rig.folder.path() / "rate.jsonl"};
  std::size_t learnt_lines = 0;
  nlohmann::json last;
  for (std::string line; std::getline(file, line);) {
    const auto json = nlohmann::json::parse(line);
    if (!json.contains("learnt")) continue;
    ++learnt_lines;
    last = json["learnt"];
  }
  ASSERT_GE(learnt_lines + 1, receiver.learnt.size()) << "the newest waits for its line";
  ASSERT_LE(learnt_lines, receiver.learnt.size());
  EXPECT_FLOAT_EQ(last["order"][2].get<float>(),
                  receiver.learnt[learnt_lines - 1].axes[2].order.value);

  MetricsBuffer buffer{};
  const std::string_view text = format_metrics(*rig.service, buffer);
  EXPECT_NE(text.find("\nzerorate_learnt_stops "), std::string_view::npos);
  EXPECT_NE(text.find("\nzerorate_learnt_order{axis=\"x\"} 0."), std::string_view::npos);
  EXPECT_NE(text.find("\nzerorate_learnt_bias_instability_sigma_dph{axis=\"y\"} "),
            std::string_view::npos);
  EXPECT_NE(text.find("\nzerorate_learnt_angle_random_walk_dps_per_sqrt_hz{axis=\"z\"} "),
            std::string_view::npos);
}

TEST(NodeServiceThatHasNotStoodYet, SaysNothingOfALearntModel) {
  ServiceRig rig;
  rig.hardware.is_moving = true;
  Receiver receiver{rig.folder.path() / "rate"};
  rig.run(520);
  (void)receiver.take();
  EXPECT_TRUE(receiver.learnt.empty());
  MetricsBuffer buffer{};
  EXPECT_EQ(format_metrics(*rig.service, buffer).find("learnt"), std::string_view::npos);
}

TEST(NodeServiceWithoutReceivers, CountsDropsUntilTheyCome) {
  ServiceRig rig;
  rig.run(300);
  const Sink& sink = *rig.service->sinks()[0];
  EXPECT_EQ(sink.sent(), 0U);
  EXPECT_GT(sink.dropped(), 250U);
  Receiver receiver{rig.folder.path() / "rate"};
  rig.run(10);
  EXPECT_EQ(sink.sent(), 10U);
  EXPECT_EQ(receiver.take().size(), 10U);
}

TEST(NodeServiceOnceMade, NeverAllocates) {
  ServiceRig rig{forget_line};
  MetricsEndpoint metrics{{.file = (rig.folder.path() / "metrics").string(),
                           .socket = (rig.folder.path() / "metrics.sock").string()}};
  MetricsBuffer text{};
  rig.run(200);
  const std::size_t excused_before = rig.hardware.allocations;
  const support::AllocationCounter allocations;
  for (int second = 0; second < 60; ++second) {
    rig.hardware.is_moving = second % 20 >= 15;
    if (second == 30) rig.hardware.rig.faults.inject({.first = rig.hardware.rig.faults.calls()});
    if (second == 40) rig.hardware.rig.chip.cycle_power();
    rig.hardware.odometer_fails = second == 50;
    rig.run(104);
    metrics.publish(format_metrics(*rig.service, text));
    metrics.serve();
  }
  rig.service->finish();
  // The faults are the test's own doing.
  const std::size_t by_the_test = 1;
  EXPECT_LE(allocations.count() - (rig.hardware.allocations - excused_before), by_the_test);
  EXPECT_GE(rig.service->counters().saves, 5U);
  EXPECT_GE(rig.service->status().counters.starts, 3U);
}

TEST(NodeServiceTick, TellsWhetherTheMeasuringThreadLives) {
  ServiceRig rig;
  rig.service->measure();
  EXPECT_TRUE(rig.service->tick());
  EXPECT_FALSE(rig.service->tick());
  rig.service->measure();
  EXPECT_TRUE(rig.service->tick());
}

TEST(Metrics, HoldTheCountersAndTheNewestMessage) {
  ServiceRig rig;
  rig.run(2080);
  const std::string socket_path = (rig.folder.path() / "metrics.sock").string();
  MetricsEndpoint metrics{{.file = (rig.folder.path() / "m.prom").string(), .socket = socket_path}};
  MetricsBuffer buffer{};
  metrics.publish(format_metrics(*rig.service, buffer));
  std::ifstream file{rig.folder.path() / "m.prom"};
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto samples = std::to_string(rig.service->status().counters.samples);
  EXPECT_NE(text.find("\nzerorate_samples_total " + samples + "\n"), std::string::npos);
  EXPECT_NE(text.find("# TYPE zerorate_samples_total counter\n"), std::string::npos);
  EXPECT_NE(text.find("zerorate_health{flag=\"calibrated\"} 1\n"), std::string::npos);
  EXPECT_NE(text.find("zerorate_bias_dps{axis=\"z\"} 0.3"), std::string::npos);
  EXPECT_NE(text.find("zerorate_gyro_running 1\n"), std::string::npos);

  const Descriptor reader{socket(AF_UNIX, SOCK_STREAM, 0)};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::ranges::copy(socket_path, std::begin(address.sun_path));
  ASSERT_EQ(connect(reader.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  metrics.serve();
  std::string served(65536, '\0');
  const ssize_t size = recv(reader.get(), served.data(), served.size(), MSG_WAITALL);
  ASSERT_GT(size, 0);
  served.resize(static_cast<std::size_t>(size));
  EXPECT_EQ(served, text);
}

TEST(NodeServiceWithASinkInTrouble, TellsItOnceAndWhenItIsOver) {
  ServiceRig rig;
  rig.run(520);
  EXPECT_EQ(std::ranges::count(log_lines(), "sink unix:" + (rig.folder.path() / "rate").string() +
                                                ": No such file or directory (does the receiver "
                                                "run?); its messages are dropped"),
            1);
  Receiver receiver{rig.folder.path() / "rate"};
  for (int i = 0; i < 208; ++i) {
    rig.run(1);
    (void)receiver.take();
  }
  EXPECT_TRUE(was_logged("rate: takes messages again"));
}

TEST(BootIdOfAFileThatIsTooShort, IsRefusedWithAReason) {
  const testing::ScratchFolder folder;
  try {
    (void)read_boot_id(folder.write("boot_id", "cut off").c_str());
    FAIL();
  } catch (const std::system_error& error) {
    EXPECT_EQ(error.code().value(), EIO);
  }
}

}  // namespace
}  // namespace zerorate::linux_node
