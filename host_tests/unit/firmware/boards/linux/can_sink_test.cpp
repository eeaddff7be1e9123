// A program of its own: it replaces the calls to the kernel that open and use a socket of CAN, as
// the machine's own kernel may have no CAN.

#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdarg>
#include <memory>
#include <utility>
#include <vector>

#include "firmware/boards/linux/outputs/sinks.hpp"
#include "hal/linux/descriptor.hpp"

namespace {

/// An interface of CAN: the other end of the only socket.
struct Interface {
  int socket = -1;
  zerorate::hal::linux_os::Descriptor bus{-1};
  int write_error = 0;  ///< answer to a frame that is written; 0: it is taken
  bool was_down = false;
};
Interface can0;

}  // namespace

extern "C" {

int socket(int domain, int type, int protocol) noexcept {
  if (domain != PF_CAN) return static_cast<int>(syscall(SYS_socket, domain, type, protocol));
  std::array<int, 2> ends{};
  if (syscall(SYS_socketpair, AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return -1;
  can0.bus = zerorate::hal::linux_os::Descriptor{ends[1]};
  return can0.socket = ends[0];
}

int ioctl(int descriptor, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  if (descriptor == can0.socket && request == SIOCGIFINDEX) {
    static_cast<ifreq*>(argument)->ifr_ifindex = 3;
    return 0;
  }
  return static_cast<int>(syscall(SYS_ioctl, descriptor, request, argument));
}

int setsockopt(int descriptor, int level, int option, const void* value, socklen_t size) noexcept {
  if (descriptor == can0.socket) return 0;
  return static_cast<int>(syscall(SYS_setsockopt, descriptor, level, option, value, size));
}

int bind(int descriptor, const sockaddr* address, socklen_t size) noexcept {
  if (descriptor == can0.socket) return 0;
  return static_cast<int>(syscall(SYS_bind, descriptor, address, size));
}

ssize_t write(int descriptor, const void* bytes, size_t size) {
  if (descriptor == can0.socket && can0.write_error != 0) {
    errno = can0.write_error;
    return -1;
  }
  return syscall(SYS_write, descriptor, bytes, size);
}

ssize_t recv(int descriptor, void* bytes, size_t size, int flags) {
  if (descriptor == can0.socket && can0.was_down) {
    can0.was_down = false;
    errno = ENETDOWN;
    return -1;
  }
  return syscall(SYS_recvfrom, descriptor, bytes, size, flags, nullptr, nullptr);
}

}  // extern "C"

namespace zerorate::linux_node {
namespace {

class SinkOnCan : public ::testing::Test {
 protected:
  /// The controller says what becomes of it.
  static void tell(canid_t state) {
    const can_frame frame{.can_id = CAN_ERR_FLAG | state};
    ASSERT_EQ(send(can0.bus.get(), &frame, sizeof frame, 0), ssize_t{sizeof frame});
  }
  void publish() const { sink_->publish({}); }
  /// Frames that reached the bus since the last time.
  static int frames() {
    int count = 0;
    can_frame frame{};
    while (recv(can0.bus.get(), &frame, sizeof frame, MSG_DONTWAIT) > 0) ++count;
    return count;
  }

  std::unique_ptr<Sink> sink_ = make_sink(CanSettings{.interface = "can0", .id = 0x300});
};

TEST_F(SinkOnCan, TellsAndCountsWhatTheQueueDoesNotTake) {
  can0.write_error = ENOBUFS;
  for (int i = 0; i < 3; ++i) publish();
  EXPECT_EQ(sink_->error_number(), ENOBUFS);
  EXPECT_EQ(sink_->dropped(), 3U);
  can0.write_error = 0;
  publish();
  EXPECT_EQ(sink_->error_number(), 0);
  EXPECT_EQ(sink_->sent(), 1U);
}

TEST_F(SinkOnCan, TellsAndCountsBusOffUntilTheRestart) {
  publish();
  EXPECT_GT(frames(), 0);
  tell(CAN_ERR_BUSOFF);
  for (int i = 0; i < 3; ++i) publish();
  EXPECT_EQ(sink_->error_number(), ECOMM);
  EXPECT_EQ(sink_->dropped(), 3U);
  EXPECT_EQ(frames(), 0);
  tell(CAN_ERR_RESTARTED);
  publish();
  EXPECT_EQ(sink_->error_number(), 0);
  EXPECT_GT(frames(), 0);
}

TEST_F(SinkOnCan, SendsAgainOnceItsInterfaceWasSetDownAndUp) {
  tell(CAN_ERR_BUSOFF);
  publish();
  EXPECT_EQ(sink_->error_number(), ECOMM);
  can0.was_down = true;
  publish();
  EXPECT_EQ(sink_->error_number(), 0);
  EXPECT_GT(frames(), 0);
}

/// Frames that reached the bus, with their sizes in bytes of the kernel's structure.
std::vector<std::pair<std::size_t, canfd_frame>> frames_on_bus() {
  std::vector<std::pair<std::size_t, canfd_frame>> frames;
  canfd_frame frame{};
  for (;;) {
    const ssize_t size = recv(can0.bus.get(), &frame, sizeof frame, MSG_DONTWAIT);
    if (size <= 0) return frames;
    frames.emplace_back(static_cast<std::size_t>(size), frame);
  }
}

TEST(CanSinkOfAYawRate, SendsOneProtectedFrameOfEachNthMessage) {
  const auto sink = make_sink(CanSettings{.interface = "can0",
                                          .id = 0x300,
                                          .layout = CanLayout::yaw,
                                          .every = 5,
                                          .e2e = {.data_id = 0x300}});
  for (std::uint32_t i = 0; i < 100; ++i) sink->publish({.sequence = 1000 + i, .message = {}});
  const auto frames = frames_on_bus();
  ASSERT_EQ(frames.size(), 20U);
  EXPECT_EQ(sink->sent(), 20U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].first, std::size_t{CAN_MTU});
    EXPECT_EQ(frames[i].second.can_id, 0x300U);
    EXPECT_EQ(frames[i].second.data[1], 0x30 | i % 15);
  }
}

TEST(CanSinkOfCanFd, SendsOneLongFrameAndSlowOnesOfEightBytes) {
  const auto sink =
      make_sink(CanSettings{.interface = "can0", .id = 0x300, .layout = CanLayout::fd});
  for (int i = 0; i < 16; ++i) sink->publish({});
  std::size_t long_frames = 0;
  std::size_t turns = 0;
  for (const auto& [size, frame] : frames_on_bus()) {
    if (frame.can_id == 0x300) {
      EXPECT_EQ(size, std::size_t{CANFD_MTU});
      EXPECT_EQ(frame.len, 24);
      ++long_frames;
    } else {
      EXPECT_EQ(size, std::size_t{CAN_MTU});
      turns += frame.can_id == 0x305 ? 1U : 0U;
    }
  }
  EXPECT_EQ(long_frames, 16U);
  EXPECT_EQ(turns, 4U);
}

TEST(CanSink, CountsWhatWasLostOnItsWayToTheBus) {
  const auto sink = make_sink(CanSettings{.interface = "can0", .id = 0x300});
  sink->publish({});
  can0.write_error = ENOBUFS;
  sink->publish({});
  can0.write_error = 0;
  sink->publish({});
  std::vector<int> counters;
  for (const auto& [size, frame] : frames_on_bus()) {
    if (frame.can_id == 0x300) counters.push_back((frame.data[0] >> 2) & 15);
  }
  EXPECT_EQ(counters, (std::vector{0, 2}));
}

}  // namespace
}  // namespace zerorate::linux_node
