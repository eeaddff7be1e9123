#include "host_tools/lib/live/source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <termios.h>
#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "core/base/numeric.hpp"
#include "firmware/wire/cobs.hpp"
#include "firmware/wire/explained_shares.hpp"
#include "firmware/wire/health_bits.hpp"
#include "hal/linux/descriptor.hpp"
#include "hal/linux/named_socket.hpp"

namespace zerorate::live {
namespace {

using hal::linux_os::checked_descriptor;
using hal::linux_os::Descriptor;

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

void take_frame(std::span<const std::uint8_t> bytes, Tally& tally) {
  if (const auto message = wire::decode_rate_frame(bytes)) {
    tally.take(*message);
  } else if (const auto status = wire::decode_status_frame(bytes)) {
    tally.status = *status;
  } else if (const auto learnt = wire::decode_learnt_frame(bytes)) {
    tally.learnt = *learnt;
  } else {
    ++tally.damaged;
  }
}

class DatagramSource : public Source {
 public:
  using Source::Source;

  bool receive(Tally& tally) override {
    // Not all that is there: under a flood there is always more, and the caller has other things to
    // do, such as to write what came and to end.
    constexpr int kMostDatagrams = 1024;
    std::array<std::uint8_t, 256> bytes{};
    for (int i = 0; i < kMostDatagrams; ++i) {
      const ssize_t size = recv(descriptor(), bytes.data(), bytes.size(), 0);
      if (size < 0) break;  // nothing more for now
      take_frame(std::span{bytes}.first(static_cast<std::size_t>(size)), tally);
    }
    return true;
  }
};

class UdpSource final : public DatagramSource {
 public:
  UdpSource(std::string name, const hal::linux_os::SocketAddress& address)
      : DatagramSource(std::move(name)),
        socket_(checked_descriptor(
            socket(address.storage.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0),
            "socket")) {
    // Room for messages that come while a recorder waits for its disk; the kernel's limit may be
    // less.
    constexpr int kBytes = 4 * 1024 * 1024;
    (void)setsockopt(socket_.get(), SOL_SOCKET, SO_RCVBUF, &kBytes, sizeof kBytes);
    if (bind(socket_.get(), address.get(), address.size) == 0) return;
    const int error = errno;
    const char* const cure =
        error == EADDRINUSE ? " (another program receives there, such as a node of ROS? a second "
                              "[[sink]] of zerorated with a port of its own serves both)"
                            : "";
    throw std::system_error(error, std::generic_category(), this->name() + cure);
  }

  [[nodiscard]] int descriptor() const override { return socket_.get(); }

 private:
  Descriptor socket_;
};

class UnixSource final : public DatagramSource {
 public:
  explicit UnixSource(const std::string& path)
      : DatagramSource("unix " + path), socket_(path, SOCK_DGRAM) {}

  [[nodiscard]] int descriptor() const override { return socket_.descriptor(); }

 private:
  hal::linux_os::NamedSocket socket_;
};

/// Bytes of a stream, read as they come.
class StreamSource : public Source {
 public:
  StreamSource(std::string name, Descriptor stream)
      : Source(std::move(name)), stream_(std::move(stream)) {}

  [[nodiscard]] int descriptor() const override { return stream_.get(); }
  bool receive(Tally& tally) final {
    std::array<std::uint8_t, 4096> bytes{};
    const ssize_t size = read(stream_.get(), bytes.data(), bytes.size());
    if (size < 0) return errno == EAGAIN || errno == EINTR;
    if (size == 0) return false;
    take(std::span{bytes}.first(static_cast<std::size_t>(size)), tally);
    return true;
  }

 private:
  virtual void take(std::span<const std::uint8_t> bytes, Tally& tally) = 0;
  Descriptor stream_;
};

class SerialSource final : public StreamSource {
 public:
  using StreamSource::StreamSource;

 private:
  void take(std::span<const std::uint8_t> bytes, Tally& tally) override {
    const std::uint32_t dropped = reader_.dropped();
    for (const std::uint8_t byte : bytes) {
      if (const auto frame = reader_.take(byte)) take_whole(*frame, tally);
    }
    if (is_in_step_) tally.damaged += reader_.dropped() - dropped;
  }
  /// Whoever joins in the middle gets the end of a frame first, which is not damage.
  void take_whole(std::span<const std::uint8_t> frame, Tally& tally) {
    const std::uint64_t damaged = tally.damaged;
    take_frame(frame, tally);
    if (!is_in_step_) tally.damaged = damaged;
    is_in_step_ = true;
  }

  wire::CobsReader<2 * wire::kMostRateFrameBytes> reader_;
  bool is_in_step_ = false;
};

class JsonSource final : public StreamSource {
 public:
  using StreamSource::StreamSource;

 private:
  /// No line of zerorated is longer; what is, is not kept.
  static constexpr std::size_t kLongestLine = 4096;

  void take(std::span<const std::uint8_t> bytes, Tally& tally) override {
    for (const std::uint8_t byte : bytes) {
      if (byte == '\n') {
        end_line(tally);
      } else if (line_.size() <= kLongestLine) {
        line_.push_back(static_cast<char>(byte));
      }
    }
  }
  void end_line(Tally& tally) {
    if (const auto line = parse_json_message(line_)) {
      tally.take(line->message);
      if (line->learnt) tally.learnt = line->learnt;
    } else {
      ++tally.damaged;
    }
    line_.clear();
  }

  std::string line_;
};

speed_t to_speed(unsigned baud) {
  constexpr std::array<std::pair<unsigned, speed_t>, 8> kSpeeds{{{9600, B9600},
                                                                 {19'200, B19200},
                                                                 {38'400, B38400},
                                                                 {57'600, B57600},
                                                                 {115'200, B115200},
                                                                 {230'400, B230400},
                                                                 {460'800, B460800},
                                                                 {921'600, B921600}}};
  const auto* const found = std::ranges::find(kSpeeds, baud, &std::pair<unsigned, speed_t>::first);
  if (found == kSpeeds.end()) {
    throw std::invalid_argument(fmt::format("{} baud: not a speed of serial lines", baud));
  }
  return found->second;
}

}  // namespace

std::unique_ptr<Source> listen_udp(const std::string& address, std::uint16_t port) {
  return std::make_unique<UdpSource>(fmt::format("udp {}:{}", address, port),
                                     hal::linux_os::udp_address(address, port));
}

std::unique_ptr<Source> listen_unix(const std::string& path) {
  return std::make_unique<UnixSource>(path);
}

std::unique_ptr<Source> open_serial(const std::string& device, unsigned baud) {
  const speed_t speed = to_speed(baud);
  Descriptor line = checked_descriptor(
      ::open(device.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC), device.c_str());
  termios settings{};
  if (tcgetattr(line.get(), &settings) != 0) fail(device);
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  if (cfsetspeed(&settings, speed) != 0 || tcsetattr(line.get(), TCSANOW, &settings) != 0) {
    fail(device);
  }
  return std::make_unique<SerialSource>("serial " + device, std::move(line));
}

std::unique_ptr<Source> open_json_lines(const std::string& file) {
  if (file == "-") {
    return std::make_unique<JsonSource>("standard input",
                                        checked_descriptor(dup(STDIN_FILENO), "standard input"));
  }
  return std::make_unique<JsonSource>(
      file, checked_descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC), file.c_str()));
}

namespace {

using nlohmann::json;

/// A whole number. A fraction or what exceeds 64 bits is as wrong as a word.
template <class Integer>
Integer read_integer(const json& number) {
  if (!number.is_number_integer() || !std::in_range<Integer>(number.get<std::int64_t>())) {
    throw json::other_error::create(503, "no whole number of this size", &number);
  }
  return number.get<Integer>();
}

void read_rates(const json& rates, app::RateMessage& message,
                core::AngularRate app::AxisRate::*member, float where_null_dps) {
  for (std::size_t i = 0; i < message.axes.size(); ++i) {
    const json& rate = rates.at(i);
    message.axes.at(i).*member =
        core::deg_per_s(rate.is_null() ? where_null_dps : rate.get<float>());
  }
}

core::Motion read_motion(const json& word) {
  for (const auto motion : {core::Motion::moving, core::Motion::settling, core::Motion::still}) {
    if (word == core::name(motion)) return motion;
  }
  throw json::other_error::create(501, "unknown motion", &word);
}

/// Members that lines of older nodes do not have.
void read_inputs(const json& line, app::RateMessage& message) {
  if (const json degc = line.value("temperature_c", json{}); !degc.is_null()) {
    const auto figure = degc.get<float>();
    if (core::is_finite(figure)) message.temperature = core::Temperature::from_degc(figure);
  }
  if (const json pulses = line.value("odometer_pulses", json{}); !pulses.is_null()) {
    message.odometer_pulses = read_integer<std::uint32_t>(pulses);
  }
}

/// Turn since departure; unknown in lines of older nodes.
void read_turn(const json& line, app::RateMessage& message) {
  if (!line.contains("turn_deg")) return;
  for (std::size_t i = 0; i < message.turn.size(); ++i) {
    const json& sigma = line.at("turn_sigma_deg").at(i);
    if (sigma.is_null()) continue;
    message.turn.at(i) = {.angle = core::deg(line.at("turn_deg").at(i).get<float>()),
                          .sigma = core::deg(sigma.get<float>())};
  }
  message.turn_time =
      core::Duration::nanoseconds(std::llround(line.at("turn_s").get<double>() * 1e9));
}

/// Numbers along x, y and z.
std::array<float, 3> read_list(const json& numbers) {
  return {numbers.at(0).get<float>(), numbers.at(1).get<float>(), numbers.at(2).get<float>()};
}

/// A direction; older nodes named an axis, such as "-z".
core::Direction read_up(const json& up) {
  if (!up.is_string()) return read_list(up);
  const auto name = up.get<std::string>();
  const std::size_t axis = std::string_view{"xyz"}.find(name.empty() ? ' ' : name.back());
  if (name.size() > 2 || axis > 2) throw json::other_error::create(503, "unknown axis", &up);
  return core::UpAxis{.axis = static_cast<std::uint8_t>(axis), .points_down = name.front() == '-'}
      .direction();
}

/// Acceleration, vibration and what the inputs explain; unknown in lines of older nodes.
void read_accelerometer(const json& line, app::RateMessage& message) {
  if (const json forces = line.value("acceleration_mps2", json{}); !forces.is_null()) {
    const auto [x, y, z] = read_list(forces);
    message.acceleration = {core::m_per_s2(x), core::m_per_s2(y), core::m_per_s2(z)};
  }
  if (const json rms = line.value("vibration_mps2", json{}); !rms.is_null()) {
    message.vibration = core::m_per_s2(rms.get<float>());
  }
  for (const wire::ExplainedShare& share : wire::kExplainedShares) {
    const json rates = line.value(std::string{share.name}, json{});
    if (rates.is_null()) continue;
    if (!message.explained) message.explained.emplace();
    for (std::size_t i = 0; i < message.explained->size(); ++i) {
      message.explained->at(i).*share.rate = core::deg_per_s(rates.at(i).get<float>());
    }
  }
}

/// Vertical and heading; unknown in lines of older nodes.
void read_vertical(const json& line, app::RateMessage& message) {
  if (const json up = line.value("up", json{}); !up.is_null()) message.up = read_up(up);
  if (const json slope = line.value("slope_deg", json{}); !slope.is_null()) {
    message.slope = core::deg(slope.get<float>());
  }
  if (const json sigma = line.value("vertical_turn_sigma_deg", json{}); !sigma.is_null()) {
    message.vertical_turn = {.angle = core::deg(line.at("vertical_turn_deg").get<float>()),
                             .sigma = core::deg(sigma.get<float>())};
  }
  if (const json sigma = line.value("heading_sigma_deg", json{}); !sigma.is_null()) {
    message.heading = {.angle = core::deg(line.at("heading_deg").get<float>()),
                       .sigma = core::deg(sigma.get<float>())};
  }
}

wire::NumberedMessage read_message(const json& line) {
  wire::NumberedMessage numbered{.sequence = read_integer<std::uint32_t>(line.at("sequence")),
                                 .message = {}};
  app::RateMessage& message = numbered.message;
  message.time = core::Instant::from_ns(read_integer<std::int64_t>(line.at("time_ns")));
  message.motion = read_motion(line.at("motion"));
  read_rates(line.at("rate_dps"), message, &app::AxisRate::corrected, 0.0F);
  read_rates(line.at("measured_dps"), message, &app::AxisRate::measured, 0.0F);
  read_rates(line.at("bias_dps"), message, &app::AxisRate::bias, 0.0F);
  read_rates(line.at("sigma_dps"), message, &app::AxisRate::sigma,
             std::numeric_limits<float>::infinity());
  const json& calm = line.at("calm_percent");
  if (!calm.is_null()) message.calm_percent = read_integer<std::uint8_t>(calm);
  read_inputs(line, message);
  read_turn(line, message);
  read_vertical(line, message);
  read_accelerometer(line, message);
  constexpr std::size_t kFirstBits = 11;  // every line has them; nodes of before lack the others
  for (std::size_t i = 0; i < wire::kHealthBits.size(); ++i) {
    const wire::HealthBit& bit = wire::kHealthBits.at(i);
    const std::string name{bit.name};
    if (i < kFirstBits || line.contains(name)) message.health.*bit.flag = line.at(name);
  }
  return numbered;
}

/// A figure that no model can have is as wrong as one that is missing.
float read_figure(const json& number) {
  const auto figure = number.get<float>();
  if (!core::is_finite(figure) || figure < 0.0F) {
    throw json::other_error::create(502, "impossible figure", &number);
  }
  return figure;
}

wire::LearntModel read_learnt(const json& member) {
  wire::LearntModel learnt;
  for (std::size_t i = 0; i < learnt.axes.size(); ++i) {
    app::LearntNoise& axis = learnt.axes.at(i);
    axis.stops = read_figure(member.at("stops"));
    for (const wire::LearntQuantity& quantity : wire::kLearntQuantities) {
      const json& value = member.at(std::string{quantity.name}).at(i);
      const json& sigma = member.at(std::string{quantity.sigma_name}).at(i);
      axis.*quantity.figure = {.value = read_figure(value) * quantity.si_per_unit,
                               .sigma = read_figure(sigma) * quantity.si_per_unit};
    }
  }
  return learnt;
}

}  // namespace

std::optional<JsonMessage> parse_json_message(std::string_view line) {
  try {
    const json parsed = json::parse(line);
    JsonMessage read{.message = read_message(parsed), .learnt = {}};
    if (parsed.contains("learnt")) read.learnt = read_learnt(parsed.at("learnt"));
    return read;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

}  // namespace zerorate::live
