#include "host_tools/lib/recording/bag_rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/time.hpp"

namespace zerorate::recording {
namespace {

constexpr std::string_view kRos1Magic = "#ROSBAG V";

/// Fields of a message, one after the other. In CDR each is aligned to its size, counted from the
/// end of the four bytes that give the byte order.
class FieldReader {
 public:
  struct Truncated {};

  /// Throws Truncated, as every function does where the message is too short.
  FieldReader(std::span<const std::byte> message, Serialization serialization)
      : bytes_(message), is_cdr_(serialization == Serialization::cdr) {
    if (!is_cdr_) return;
    const auto options = take<kCdrHeaderBytes>();
    is_big_endian_ = (options[1] & std::byte{1}) == std::byte{0};
  }

  [[nodiscard]] bool is_cdr() const { return is_cdr_; }
  std::uint32_t uint32() { return number<std::uint32_t>(); }
  double float64() { return std::bit_cast<double>(number<std::uint64_t>()); }
  void skip_float64(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) static_cast<void>(float64());
  }
  void skip_string() {
    const std::uint32_t length = uint32();
    if (length > bytes_.size() - offset_) throw Truncated{};
    offset_ += length;
  }

 private:
  static constexpr std::size_t kCdrHeaderBytes = 4;

  template <std::size_t Count>
  std::array<std::byte, Count> take() {
    std::array<std::byte, Count> taken{};
    if (bytes_.size() < Count || offset_ > bytes_.size() - Count) throw Truncated{};
    std::memcpy(taken.data(), bytes_.data() + offset_, Count);
    offset_ += Count;
    return taken;
  }

  template <class Number>
  Number number() {
    constexpr std::size_t kSize = sizeof(Number);
    if (is_cdr_) offset_ += (kSize - (offset_ - kCdrHeaderBytes) % kSize) % kSize;
    auto bytes = take<kSize>();
    if (is_big_endian_ != (std::endian::native == std::endian::big)) std::ranges::reverse(bytes);
    return std::bit_cast<Number>(bytes);
  }

  std::span<const std::byte> bytes_;
  std::size_t offset_ = 0;
  bool is_cdr_;
  bool is_big_endian_ = false;
};

/// std_msgs/Header, which in ROS 1 begins with a number and has seconds without a sign; nanoseconds
/// since 1970.
std::int64_t take_stamp(FieldReader& message) {
  constexpr std::int64_t kNsPerSecond = 1'000'000'000;
  if (!message.is_cdr()) static_cast<void>(message.uint32());
  const std::uint32_t bits = message.uint32();
  const std::int64_t seconds =
      message.is_cdr() ? static_cast<std::int32_t>(bits) : std::int64_t{bits};
  const std::int64_t stamp_ns = seconds * kNsPerSecond + message.uint32();
  message.skip_string();
  return stamp_ns;
}

/// A vector with its covariance, which begins with -1 where the vector is not measured: then NaN.
void take_vector(FieldReader& message, std::array<float, kMaxAxes>& vector) {
  constexpr std::size_t kCovariance = 9;
  for (float& along : vector) along = static_cast<float>(message.float64());
  const bool is_absent = message.float64() == -1.0;
  if (is_absent) vector.fill(std::numeric_limits<float>::quiet_NaN());
  message.skip_float64(kCovariance - 1);
}

/// Rest of a sensor_msgs/Imu behind its header.
void take_rates(FieldReader& message, Row& row) {
  constexpr std::size_t kOrientation = 4 + 9;
  message.skip_float64(kOrientation);
  take_vector(message, row.rate_rad_s);
  take_vector(message, row.acceleration_m_s2);
}

/// Size of a vector.
float take_size(FieldReader& message) {
  const double x = message.float64();
  const double y = message.float64();
  return static_cast<float>(std::hypot(x, y, message.float64()));
}

/// geometry_msgs/Twist. The whole vectors count: whatever moves is not at rest.
void take_twist(FieldReader& message, Row& row) {
  row.speed_m_s = take_size(message);
  row.turn_rad_s = take_size(message);
}

/// Rest of a nav_msgs/Odometry behind its header.
void take_odometry(FieldReader& message, Row& row) {
  constexpr std::size_t kPose = 3 + 4 + 36;
  message.skip_string();
  message.skip_float64(kPose);
  take_twist(message, row);
}

/// The rest of a message behind its header.
void take_fields(FieldReader& message, MessageType type, Row& row) {
  switch (type) {
    case MessageType::imu:
      return take_rates(message, row);
    case MessageType::odometry:
      return take_odometry(message, row);
    case MessageType::twist_stamped:
    case MessageType::twist:
      return take_twist(message, row);
    case MessageType::bias:
      return;
  }
}

struct Topic {
  std::string name;
  MessageType type;
};

/// Option and types of the messages for rates or motion. Without a name only the first type counts:
/// a Twist may be a command that nobody obeyed.
struct Wanted {
  const char* option;
  std::vector<MessageType> types;
};

Wanted wanted_for(Needs needs) {
  if (needs == Needs::rates) return {"--topic", {MessageType::imu}};
  return {"--odometry-topic",
          {MessageType::odometry, MessageType::twist_stamped, MessageType::twist}};
}

/// Refuses rates that the node of ROS has corrected, unless their user names them.
void refuse_corrected(Bag& bag, const std::string& topic) {
  constexpr std::string_view kData = "imu/data";
  if (!topic.ends_with(kData)) return;
  const std::string bias = topic.substr(0, topic.size() - kData.size()) + "imu/bias";
  const std::vector<std::string> biases = bag.topics(MessageType::bias);
  if (std::ranges::find(biases, bias) == biases.end()) return;
  throw Error{{bag.file().string()},
              fmt::format("{} beside {}: rates whose bias was already taken out", topic, bias),
              "rates as the chip gave them",
              fmt::format("Record imu/data_raw; to take them all the same, --topic {}.", topic)};
}

/// The topic that is meant: the one named, or the only one with such messages.
Topic choose_topic(Bag& bag, Needs needs, const std::string& named) {
  const Wanted wanted = wanted_for(needs);
  const std::span<const MessageType> types{wanted.types.data(),
                                           named.empty() ? 1 : wanted.types.size()};
  std::vector<Topic> topics;
  std::vector<std::string> names;
  std::vector<std::string_view> type_names;
  for (const MessageType type : types) {
    type_names.push_back(bag.format().name_of(type));
    for (std::string& name : bag.topics(type)) {
      names.push_back(name);
      topics.push_back({std::move(name), type});
    }
  }
  const std::string type = fmt::format("{}", fmt::join(type_names, ", "));
  const std::string list = fmt::format("{}", fmt::join(names, ", "));
  const Place place{bag.file().string()};
  if (topics.empty()) {
    throw Error{place, fmt::format("no topic with messages of {}", type), "one such topic",
                fmt::format("See what the bag holds: {}.", bag.format().info_command)};
  }
  if (named.empty()) {
    if (topics.size() == 1) {
      if (needs == Needs::rates) refuse_corrected(bag, names.front());
      return topics.front();
    }
    throw Error{place, fmt::format("{} topics with messages of {}", topics.size(), type), list,
                fmt::format("Name the one that is meant: {}.", wanted.option)};
  }
  const auto found = std::ranges::find(topics, named, &Topic::name);
  if (found != topics.end()) return *found;
  throw Error{place, fmt::format("no topic {} with messages of {}", excerpt(named), type), list,
              fmt::format("Name one of them: {}.", wanted.option)};
}

}  // namespace

bool file_begins_with(const std::filesystem::path& file, std::string_view text) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;  // a pipe is read once only
  std::string begin(text.size(), '\0');
  std::ifstream{file, std::ios::binary}.read(begin.data(),
                                             static_cast<std::streamsize>(begin.size()));
  return begin == text;
}

std::unique_ptr<Bag> open_bag(const std::filesystem::path& path) {
  if (!file_begins_with(path, kRos1Magic)) {
    auto mcap = open_mcap_bag(path);
    return mcap ? std::move(mcap) : open_ros2_bag(path);
  }
#ifdef ZERORATE_HAS_ROSBAG
  return open_ros1_bag(path);
#else
  throw Error{{path.string()},
              "a bag of ROS 1, for which this build lacks a library",
              "a CSV or CSV.gz file, or a bag of ROS 2",
              "Install librosbag-storage-dev and build again, or convert the bag: "
              "rosbags-convert --src run.bag --dst run_db3."};
#endif
}

BagRows::BagRows(std::unique_ptr<Bag> bag, Needs needs, const std::string& topic)
    : bag_(std::move(bag)),
      columns_{.rate_unit = RateUnit::rad_per_s, .speed = needs == Needs::motion} {
  const Topic chosen = choose_topic(*bag_, needs, topic);
  topic_ = chosen.name;
  type_ = chosen.type;
  messages_known_ = bag_->select(topic_, type_);
  first_ = take_first();
  columns_.acceleration = first_->has_acceleration();
}

Row BagRows::take_first() {
  BagMessage message;
  if (bag_->next(message)) return decode(message, 1);
  throw Error{{bag_->file().string()},
              "no messages of " + topic_,
              "at least one message",
              "Check that the bag was recorded to its end."};
}

bool BagRows::next(Row& row) {
  BagMessage message;
  if (!first_ && !bag_->next(message)) return false;
  ++messages_;
  row = first_ ? *first_ : decode(message, messages_);
  if (!columns_.acceleration) row.acceleration_m_s2 = kNoAcceleration;
  first_.reset();
  return true;
}

Row BagRows::decode(const BagMessage& message, std::uint64_t number) const {
  const auto bad = [&](const char* found, std::string_view expected) {
    return Error{{bag_->file().string()},
                 fmt::format("{} as message {} of {}", found, number, topic_),
                 std::string(expected),
                 "The bag may be damaged, or its type of message another one."};
  };
  Row row;
  try {
    FieldReader reader{message.bytes, bag_->format().serialization};
    const std::int64_t stamp_ns = type_ == MessageType::twist ? 0 : take_stamp(reader);
    row.time_ns = stamp_ns != 0 ? stamp_ns : message.recorded_ns;
    take_fields(reader, type_, row);
  } catch (const FieldReader::Truncated&) {
    throw bad("a message that ends early", bag_->format().name_of(type_));
  }
  if (!core::is_in_range(core::Instant::from_ns(row.time_ns)))
    throw bad("an impossible time", "a time since 1970");
  return row;
}

std::optional<double> BagRows::fraction_read() const {
  if (messages_known_ == 0) return std::nullopt;
  return static_cast<double>(messages_) / static_cast<double>(messages_known_);
}

}  // namespace zerorate::recording
