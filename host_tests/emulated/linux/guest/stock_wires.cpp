#include "host_tests/emulated/linux/guest/stock_wires.hpp"

#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <linux/spi/spidev.h>
#include <poll.h>
#include <sched.h>
#include <sys/uio.h>
#include <termios.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace zerorate::emulated {
namespace {

template <class T>
T take(std::span<const std::uint8_t> bytes, std::size_t index = 0) {
  T value{};
  std::memcpy(&value, bytes.data() + index * sizeof(T), sizeof(T));
  return value;
}

template <class T>
std::span<const std::uint8_t> bytes_of(const T& value) {
  return {reinterpret_cast<const std::uint8_t*>(&value), sizeof value};
}

fuse_ioctl_iovec at(std::uint64_t base, std::size_t size) {
  return {.base = base, .len = size};
}

std::uint64_t address_of(const void* pointer) {
  return reinterpret_cast<std::uintptr_t>(pointer);
}

std::size_t size_of(std::span<const fuse_ioctl_iovec> vectors) {
  std::size_t size = 0;
  for (const fuse_ioctl_iovec& vector : vectors) size += vector.len;
  return size;
}

std::uint32_t direction_of(bool is_written, bool is_read) {
  std::uint32_t direction = 0;
  if (is_written) direction |= ZERORATE_SEGMENT_WRITE;
  if (is_read) direction |= ZERORATE_SEGMENT_READ;
  return direction;
}

}  // namespace

CuseBus::CuseBus(std::uint32_t kind, const char* name)
    : kind_(kind), cuse_(open_device("/dev/cuse", O_RDWR)) {
  name_device(name);
}

void CuseBus::name_device(const char* name) {
  if (read(cuse_, request_.data(), request_.size()) < 0) give_up("/dev/cuse");
  const auto head = take<fuse_in_header>(request_);
  const auto asked = take<cuse_init_in>(std::span{request_}.subspan(sizeof head));
  unique_ = head.unique;
  cuse_init_out answer{};
  answer.major = asked.major;
  answer.minor = asked.minor;
  answer.flags = CUSE_UNRESTRICTED_IOCTL;
  answer.max_read = answer.max_write = 1U << 16U;
  std::string text = std::string("DEVNAME=") + name;
  text.push_back('\0');
  reply(0, bytes_of(answer), {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

bool CuseBus::next(std::span<std::uint8_t> transaction) {
  const ssize_t size = read(cuse_, request_.data(), request_.size());
  if (size < 0) return false;
  const auto head = take<fuse_in_header>(request_);
  const auto body = std::span{request_}.first(static_cast<std::size_t>(size)).subspan(sizeof head);
  unique_ = head.unique;
  switch (head.opcode) {
    case FUSE_OPEN:
      reply(0, bytes_of(fuse_open_out{.fh = 0, .open_flags = FOPEN_DIRECT_IO, .padding = 0}));
      return false;
    case FUSE_IOCTL: {
      const auto in = take<fuse_ioctl_in>(body);
      return ioctl({in, body.subspan(sizeof in, in.in_size)}, transaction);
    }
    case FUSE_INTERRUPT:  // whoever waited is gone: there is nobody to answer
      return false;
    default:
      reply(head.opcode == FUSE_RELEASE ? 0 : -ENOSYS, {});
      return false;
  }
}

bool CuseBus::ioctl(const Call& call, std::span<std::uint8_t> transaction) {
  return kind_ == ZERORATE_BUS_SPI ? spi(call, transaction) : i2c(call, transaction);
}

bool CuseBus::spi(const Call& call, std::span<std::uint8_t> transaction) {
  const std::size_t size = _IOC_SIZE(call.in.cmd);
  Vectors in{at(call.in.arg, size)};
  if (call.in.in_size < size) return ask_for(in, {}), false;
  if (call.in.cmd == SPI_IOC_WR_MODE) mode_ = call.data[0];
  if (_IOC_NR(call.in.cmd) != 0) return finish(0), false;
  zerorate_bus_transaction head{.bus = kind_, .mode = mode_};
  Vectors out;
  for (std::size_t i = 0; i < size / sizeof(spi_ioc_transfer); ++i) {
    const auto transfer = take<spi_ioc_transfer>(call.data, i);
    const bool is_read = transfer.rx_buf != 0;
    const bool is_written = transfer.tx_buf != 0;
    if (is_written) in.push_back(at(transfer.tx_buf, transfer.len));
    if (is_read) out.push_back(at(transfer.rx_buf, transfer.len));
    head.speed_hz = transfer.speed_hz;
    head.segment[head.segments++] = {.length = transfer.len,
                                     .direction = direction_of(is_written, is_read)};
  }
  if (call.in.in_size < size_of(in)) return ask_for(in, out), false;
  return begin(call.data.subspan(size), head, transaction);
}

bool CuseBus::i2c(const Call& call, std::span<std::uint8_t> transaction) {
  if (call.in.cmd != I2C_RDWR) return finish(-ENOTTY), false;
  Vectors in{at(call.in.arg, sizeof(i2c_rdwr_ioctl_data))};
  if (call.in.in_size < size_of(in)) return ask_for(in, {}), false;
  const auto request = take<i2c_rdwr_ioctl_data>(call.data);
  in.push_back(at(address_of(request.msgs), request.nmsgs * sizeof(i2c_msg)));
  const std::size_t size = size_of(in);
  if (call.in.in_size < size) return ask_for(in, {}), false;
  zerorate_bus_transaction head{.bus = kind_};
  Vectors out;
  for (std::size_t i = 0; i < request.nmsgs; ++i) {
    const auto message = take<i2c_msg>(call.data.subspan(sizeof request), i);
    const bool is_read = (message.flags & I2C_M_RD) != 0;
    (is_read ? out : in).push_back(at(address_of(message.buf), message.len));
    head.address = message.addr;
    head.segment[head.segments++] = {
        .length = message.len,
        .direction = is_read ? ZERORATE_SEGMENT_READ : ZERORATE_SEGMENT_WRITE};
  }
  if (call.in.in_size < size_of(in)) return ask_for(in, out), false;
  return begin(call.data.subspan(size), head, transaction);
}

/// @param written  the bytes of all segments that are written, in order
bool CuseBus::begin(std::span<const std::uint8_t> written, const zerorate_bus_transaction& head,
                    std::span<std::uint8_t> transaction) {
  pending_ = head;
  std::ranges::copy(bytes_of(head), transaction.begin());
  auto to = transaction.subspan(sizeof head);
  for (std::size_t i = 0; i < head.segments; ++i) {
    const auto segment = to.first(head.segment[i].length);
    to = to.subspan(segment.size());
    std::ranges::fill(segment, std::uint8_t{0});
    if ((head.segment[i].direction & ZERORATE_SEGMENT_WRITE) == 0) continue;
    std::ranges::copy(written.first(segment.size()), segment.begin());
    written = written.subspan(segment.size());
  }
  return true;
}

void CuseBus::answer(std::span<const std::uint8_t> answer) {
  const auto status = take<zerorate_bus_answer>(answer).status;
  if (status < 0) return finish(status);
  auto from = answer.subspan(sizeof(zerorate_bus_answer));
  std::vector<std::uint8_t> read;
  std::size_t all = 0;
  for (std::size_t i = 0; i < pending_.segments; ++i) {
    const auto segment = from.first(pending_.segment[i].length);
    from = from.subspan(segment.size());
    all += segment.size();
    if ((pending_.segment[i].direction & ZERORATE_SEGMENT_READ) == 0) continue;
    read.insert(read.end(), segment.begin(), segment.end());
  }
  finish(kind_ == ZERORATE_BUS_SPI ? static_cast<int>(all) : static_cast<int>(pending_.segments),
         read);
}

void CuseBus::ask_for(const Vectors& in, const Vectors& out) {
  const fuse_ioctl_out head{.result = 0,
                            .flags = FUSE_IOCTL_RETRY,
                            .in_iovs = static_cast<std::uint32_t>(in.size()),
                            .out_iovs = static_cast<std::uint32_t>(out.size())};
  Vectors both{in};
  both.insert(both.end(), out.begin(), out.end());
  reply(0, bytes_of(head),
        {reinterpret_cast<const std::uint8_t*>(both.data()), both.size() * sizeof both[0]});
}

/// @param result  of the system call: a negative error number, or what the driver returns
void CuseBus::finish(int result, std::span<const std::uint8_t> data) {
  reply(0, bytes_of(fuse_ioctl_out{.result = result, .flags = 0, .in_iovs = 0, .out_iovs = 0}),
        data);
}

void CuseBus::reply(int error, std::span<const std::uint8_t> first,
                    std::span<const std::uint8_t> second) {
  const fuse_out_header head{
      .len = static_cast<std::uint32_t>(sizeof(fuse_out_header) + first.size() + second.size()),
      .error = error,
      .unique = unique_};
  std::vector<std::uint8_t> all(bytes_of(head).begin(), bytes_of(head).end());
  all.insert(all.end(), first.begin(), first.end());
  all.insert(all.end(), second.begin(), second.end());
  (void)!write(cuse_, all.data(), all.size());
}

StockWires::StockWires()
    : buses_{CuseBus{ZERORATE_BUS_SPI, "spidev0.0"}, CuseBus{ZERORATE_BUS_I2C, "i2c-7"}},
      console_(open_device("/dev/ttyAMA0", O_RDWR | O_NONBLOCK)) {
  termios settings{};
  (void)tcgetattr(console_, &settings);
  cfmakeraw(&settings);
  (void)tcsetattr(console_, TCSANOW, &settings);
}

bool StockWires::next(std::span<std::uint8_t> transaction) {
  std::array<pollfd, 2> sources{{{.fd = buses_[0].descriptor(), .events = POLLIN, .revents = 0},
                                 {.fd = buses_[1].descriptor(), .events = POLLIN, .revents = 0}}};
  (void)poll(sources.data(), sources.size(), -1);
  asking_ = &buses_.at((sources[0].revents & POLLIN) != 0 ? 0 : 1);
  return asking_->next(transaction);
}

void StockWires::answer(std::span<const std::uint8_t> answer) {
  asking_->answer(answer);
}

/// Computes while it waits: if the processor slept, virtual time would run away from the answer.
void StockWires::drive(int line, bool high) {
  const std::lock_guard lock(mutex_);
  bool& level = levels_.at(static_cast<std::size_t>(line));
  if (level == high) return;
  level = high;
  const std::string text = "LINE " + std::to_string(line) + (high ? " 1\n" : " 0\n");
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t size = write(console_, text.data() + written, text.size() - written);
    if (size > 0) written += static_cast<std::size_t>(size);
  }
  char done = 0;
  while (read(console_, &done, 1) != 1) (void)sched_yield();
}

}  // namespace zerorate::emulated
