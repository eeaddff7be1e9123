/// @file
/// The single parts of the way out: sinks, the queue between the threads, the service
/// manager.

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>
#include <vector>

#include "firmware/boards/linux/message_queue.hpp"
#include "firmware/boards/linux/node_service.hpp"
#include "firmware/boards/linux/outputs/can_sink.hpp"
#include "firmware/boards/linux/outputs/sinks.hpp"
#include "firmware/boards/linux/process/error_stream.hpp"
#include "firmware/boards/linux/process/process.hpp"
#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tests/unit/firmware/boards/linux/simulated_hardware.hpp"
#include "host_tests/unit/firmware/wire/messages.hpp"

namespace zerorate::linux_node {
namespace {

using wire::NumberedMessage;
using wire::testing::random_message;

TEST(UdpSink, SendsOneFrameADatagram) {
  const Descriptor receiver{socket(AF_INET, SOCK_DGRAM, 0)};
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(receiver.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(getsockname(receiver.get(), reinterpret_cast<sockaddr*>(&address), &size), 0);
  const timeval limit{.tv_sec = 5, .tv_usec = 0};
  setsockopt(receiver.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);

  const auto sink = make_sink(UdpSettings{"127.0.0.1", ntohs(address.sin_port)});
  std::mt19937_64 random{7};
  for (int i = 0; i < 100; ++i) {
    const NumberedMessage sent = random_message(random);
    sink->publish(sent);
    std::array<std::uint8_t, 200> bytes{};
    const ssize_t received = recv(receiver.get(), bytes.data(), bytes.size(), 0);
    ASSERT_GT(received, 0);
    const auto frame = std::span{bytes}.first(static_cast<std::size_t>(received));
    EXPECT_EQ(*wire::decode_rate_frame(frame), sent);
  }
  EXPECT_EQ(sink->sent(), 100U);
}

TEST(UdpSinkWithoutAReceiver, GoesOn) {
  const auto sink = make_sink(UdpSettings{"127.0.0.1", 9});
  for (int i = 0; i < 10; ++i) sink->publish({});
  EXPECT_EQ(sink->sent() + sink->dropped(), 10U);
}

TEST(SinksThatCannotBeTried, AreRefused) {
  EXPECT_THROW((void)make_sink(UdpSettings{"localhost", 9}), std::invalid_argument);
  EXPECT_THROW((void)make_sink(UnixSettings{std::string(200, 'x')}), std::invalid_argument);
  EXPECT_THROW((void)make_sink(CanSettings{"a-name-that-is-too-long", 0}), std::invalid_argument);
}

TEST(JsonSinkWhoseFolderIsNotThere, WritesOnceItHasCome) {
  const testing::ScratchFolder folder;
  const auto file = folder.path() / "later" / "rate.jsonl";
  const auto sink = make_sink(JsonSettings{file.string()});
  std::mt19937_64 random{1};
  const auto publish = [&] { sink->publish(random_message(random)); };
  publish();
  EXPECT_EQ(sink->error_number(), ENOENT);
  std::filesystem::create_directories(file.parent_path());
  for (int i = 0; i < 100; ++i) publish();
  EXPECT_EQ(sink->error_number(), 0);
  EXPECT_GT(sink->sent(), 0U);
}

TEST(CanController, IsBusOffFromItsErrorFrameUntilItsRestart) {
  EXPECT_FALSE(is_bus_off_after(0x200, false));
  EXPECT_TRUE(is_bus_off_after(CAN_ERR_FLAG | CAN_ERR_BUSOFF, false));
  EXPECT_TRUE(is_bus_off_after(0x200, true));
  EXPECT_TRUE(is_bus_off_after(CAN_ERR_FLAG | CAN_ERR_ACK, true));
  EXPECT_FALSE(is_bus_off_after(CAN_ERR_FLAG | CAN_ERR_RESTARTED, true));
}

/// A descriptor of a pipe that nobody reads, full.
TEST(ErrorStream, DropsLinesThatNobodyTakesAndTellsHowMany) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC), 0);
  const Descriptor reader{ends[0]};
  const Descriptor writer{ends[1]};
  const std::array<char, 4096> page{};
  while (write(writer.get(), page.data(), page.size()) > 0) {
  }
  ASSERT_EQ(fcntl(writer.get(), F_SETFL, 0), 0);  // it would wait
  ErrorStream stream{writer.get()};
  stream.write_line("first");
  stream.write_line("second");
  EXPECT_EQ(stream.lost(), 2U);
  std::array<char, 4096> read_back{};
  while (read(reader.get(), read_back.data(), read_back.size()) > 0) {
  }
  stream.write_line("third");
  stream.write_line("third");
  const ssize_t size = read(reader.get(), read_back.data(), read_back.size());
  ASSERT_GT(size, 0);
  EXPECT_EQ((std::string_view{read_back.data(), static_cast<std::size_t>(size)}),
            "zerorated: 2 lines of this log were lost\nzerorated: third\n");
}

TEST(ErrorStream, TellsALineThatRepeatsItselfOnceAMinute) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC), 0);
  const Descriptor reader{ends[0]};
  const Descriptor writer{ends[1]};
  ErrorStream stream{writer.get()};
  for (int second = 0; second <= 60; ++second) {
    const auto now = core::Instant::from_ns(0) + core::Duration::seconds(second);
    stream.write_line("fails", now);
    if (second == 30) stream.write_line("other", now);
  }
  std::array<char, 4096> read_back{};
  const ssize_t size = read(reader.get(), read_back.data(), read_back.size());
  ASSERT_GT(size, 0);
  EXPECT_EQ((std::string_view{read_back.data(), static_cast<std::size_t>(size)}),
            "zerorated: fails\nzerorated: other\nzerorated: fails (59 times more meanwhile)\n");
  EXPECT_EQ(stream.lost(), 0U);
}

TEST(ErrorStreamThatIsClosed, IsNoError) {
  ErrorStream stream{-1};
  stream.write_line("line");
  EXPECT_EQ(stream.lost(), 1U);
}

TEST(CanSinkWithoutItsInterface, DropsAndGoesOn) {
  const auto sink = make_sink(CanSettings{"zrnone0", 0x200});
  for (int i = 0; i < 250; ++i) sink->publish({});
  EXPECT_EQ(sink->dropped(), 250U);
}

TEST(JsonSinkWhoseReaderStalls, DropsInsteadOfWaiting) {
  testing::ScratchFolder folder;
  const std::string path = (folder.path() / "pipe").string();
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const Descriptor reader{open(path.c_str(), O_RDONLY | O_NONBLOCK)};
  const auto sink = make_sink(JsonSettings{path});
  for (int i = 0; i < 500; ++i) sink->publish({});  // a pipe holds 64 KiB
  EXPECT_GT(sink->sent(), 50U);
  EXPECT_GT(sink->dropped(), 50U);
}

TEST(JsonSinkOnAFifo, GivesItsReaderTheMessagesFromSoonAfterItCame) {
  const testing::ScratchFolder folder;
  const std::string path = (folder.path() / "fifo").string();
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const auto sink = make_sink(JsonSettings{path});
  for (int i = 0; i < 150; ++i) sink->publish({});
  EXPECT_EQ(sink->dropped(), 150U);
  for (int visit = 0; visit < 2; ++visit) {
    const std::uint64_t before = sink->sent();
    const Descriptor reader{open(path.c_str(), O_RDONLY | O_NONBLOCK)};
    for (int i = 0; i < 110; ++i) sink->publish({});
    EXPECT_GE(sink->sent(), before + 10) << visit;
    std::vector<char> lines(65'536);  // all that a pipe holds: the rest would go to the next reader
    ASSERT_GT(read(reader.get(), lines.data(), lines.size()), 0);
    EXPECT_EQ(lines[0], '{');
  }
}

TEST(JsonSinkOnAFullDisk, LeavesNoPartOfALine) {
  const testing::ScratchFolder folder;
  const std::string path = (folder.path() / "lines.json").string();
  const auto sink = make_sink(JsonSettings{path});
  {
    const testing::FileSizeLimit full{1000};
    for (int i = 0; i < 10; ++i) sink->publish({});
  }
  EXPECT_GT(sink->dropped(), 0U);
  sink->publish({});
  std::ifstream file{path};
  std::uint64_t lines = 0;
  for (std::string line; std::getline(file, line); ++lines) {
    EXPECT_TRUE(nlohmann::json::accept(line)) << line;
  }
  EXPECT_EQ(lines, sink->sent());
}

TEST(MessageQueueBetweenTwoThreads, KeepsOrderAndShowsLosses) {
  const auto queue = std::make_unique<MessageQueue>();
  constexpr std::uint32_t kMessages = 200'000;
  std::thread writer([&] {
    for (std::uint32_t i = 0; i < kMessages; ++i) {
      queue->publish({.time = core::Instant::from_ns(i)});
    }
  });
  std::uint32_t expected = 0;
  std::uint32_t missing = 0;
  std::uint32_t taken = 0;
  const auto take_all = [&] {
    while (const auto message = queue->take()) {
      EXPECT_EQ(message->message.time.ns(), message->sequence);
      missing += message->sequence - expected;
      expected = message->sequence + 1;
      ++taken;
    }
  };
  while (expected < kMessages / 2 && queue->dropped() + taken < kMessages) take_all();
  writer.join();
  take_all();
  missing += kMessages - expected;
  EXPECT_EQ(missing, queue->dropped());
  EXPECT_EQ(taken + missing, kMessages);
}

TEST(ServiceManager, IsToldThroughItsSocket) {
  testing::ScratchFolder folder;
  const std::string path = (folder.path() / "notify").string();
  const Descriptor socket{::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)};
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::ranges::copy(path, std::begin(address.sun_path));
  ASSERT_EQ(bind(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(setenv("NOTIFY_SOCKET", path.c_str(), 1), 0);
  notify_service_manager("READY=1");
  unsetenv("NOTIFY_SOCKET");
  notify_service_manager("WATCHDOG=1");  // nobody listens
  std::array<char, 64> text{};
  EXPECT_EQ(recv(socket.get(), text.data(), text.size(), 0), 7);
  EXPECT_STREQ(text.data(), "READY=1");
  EXPECT_LT(recv(socket.get(), text.data(), text.size(), 0), 0);
}

struct Trouble {
  BusKind bus;
  drivers::DriverError error;
  GyroReason reason;
  std::string words;
};

TEST(ErrorOfTheGyro, IsToldWithPlaceReasonAndCure) {
  using drivers::DriverErrorCode;
  const auto bus_error = [](hal::BusError error) {
    return drivers::DriverError{DriverErrorCode::bus_failed, error, 0x0F};
  };
  const std::vector<Trouble> troubles{
      {BusKind::i2c,
       bus_error(hal::BusError::not_present),
       {.error_number = EACCES},
       "/dev/i2c-1: Permission denied (is the user in the device's group, i2c or spi?)"},
      {BusKind::spi,
       bus_error(hal::BusError::not_present),
       {.error_number = ENOENT},
       "/dev/i2c-1: No such file or directory (is the bus enabled, and its name right? zerorate "
       "probe)"},
      {BusKind::i2c,
       bus_error(hal::BusError::timeout),
       {.error_number = EBUSY},
       "/dev/i2c-1 at 0x6a: bus failed (timeout) at register 0x0f: Device or resource busy (does "
       "another program or a driver of the kernel use it?)"},
      {BusKind::i2c,
       bus_error(hal::BusError::io),
       {.error_number = ENOTTY},
       "/dev/i2c-1 at 0x6a: bus failed (input/output error) at register 0x0f: Inappropriate ioctl "
       "for device (is it a node of i2c-dev or spidev?)"},
      {BusKind::i2c,
       bus_error(hal::BusError::nack),
       {.error_number = ENXIO},
       "/dev/i2c-1 at 0x6a: bus failed (not acknowledged) at register 0x0f (are the wiring and the "
       "address right? zerorate probe)"},
      {BusKind::i2c,
       {DriverErrorCode::wrong_identity, {}, 0x0F},
       {.identity = 0x69},
       "/dev/i2c-1 at 0x6a answered 0x69, lsm6dso answers 0x6c: is it another chip? zerorate "
       "probe"},
      {BusKind::spi, {DriverErrorCode::frozen, {}, 0b101}, {}, "/dev/i2c-1: frozen on axis x z"},
  };
  for (const Trouble& trouble : troubles) {
    const GyroSettings gyro{
        .chip = "lsm6dso", .bus = trouble.bus, .device = "/dev/i2c-1", .address = 0x6A};
    LogBuffer words{};
    EXPECT_EQ(describe(gyro, trouble.error, trouble.reason, words), trouble.words);
  }
}

TEST(ConfigurationInOneLine, NamesChipRateModelAndOdometer) {
  const Configuration configuration = parse_configuration(kMinimalConfiguration, "test.toml");
  EXPECT_EQ(describe(configuration),
            "lsm6dso on /dev/spidev0.0, 104 Hz, 250 deg/s, model lsm6dso, odometer /dev/gpiochip0 "
            "line 24");
}

}  // namespace
}  // namespace zerorate::linux_node
