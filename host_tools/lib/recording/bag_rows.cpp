#include "host_tools/lib/recording/bag_rows.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/base/time.hpp"

namespace zerorate::recording {
namespace {

constexpr std::string_view kSqliteMagic = "SQLite format 3";
constexpr const char* kTopics =
    "SELECT name FROM topics WHERE type IN (?1, ?2) AND serialization_format = 'cdr' ORDER BY name";
constexpr const char* kMessages =
    "SELECT timestamp, data FROM messages JOIN topics ON topics.id = topic_id WHERE name = ?1 "
    "ORDER BY timestamp, messages.id";
constexpr const char* kCount =
    "SELECT COUNT(*) FROM messages JOIN topics ON topics.id = topic_id WHERE name = ?1";
constexpr const char* kFirstTime = "SELECT COALESCE(MIN(timestamp), 0) FROM messages";

/// Name of a message's type, as ROS 2 and as ROS 1 write it.
std::array<const char*, 2> type_names(Needs needs) {
  if (needs == Needs::rates) return {"sensor_msgs/msg/Imu", "sensor_msgs/Imu"};
  return {"nav_msgs/msg/Odometry", "nav_msgs/Odometry"};
}

/// Fields of a message in CDR (OMG formal/02-06-51, 15.3): each is aligned to its size, counted
/// from the end of the four bytes that tell the byte order.
class CdrReader {
 public:
  struct Truncated {};

  /// Throws Truncated, as every function does where the message is too short.
  explicit CdrReader(std::span<const std::byte> message) : bytes_(message) {
    const auto options = take<kHeaderBytes>();
    is_big_endian_ = (options[1] & std::byte{1}) == std::byte{0};
  }

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
  static constexpr std::size_t kHeaderBytes = 4;

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
    offset_ += (kSize - (offset_ - kHeaderBytes) % kSize) % kSize;
    auto bytes = take<kSize>();
    if (is_big_endian_ != (std::endian::native == std::endian::big)) std::ranges::reverse(bytes);
    return std::bit_cast<Number>(bytes);
  }

  std::span<const std::byte> bytes_;
  std::size_t offset_ = 0;
  bool is_big_endian_ = false;
};

/// std_msgs/Header; nanoseconds since 1970.
std::int64_t take_stamp(CdrReader& message) {
  constexpr std::int64_t kNsPerSecond = 1'000'000'000;
  const auto seconds = static_cast<std::int32_t>(message.uint32());
  const std::int64_t stamp_ns = std::int64_t{seconds} * kNsPerSecond + message.uint32();
  message.skip_string();
  return stamp_ns;
}

/// Rest of a sensor_msgs/Imu behind its header.
void take_rates(CdrReader& message, Row& row) {
  constexpr std::size_t kOrientation = 4 + 9;
  message.skip_float64(kOrientation);
  for (float& rate : row.rate_rad_s) rate = static_cast<float>(message.float64());
  const bool is_absent = message.float64() == -1.0;
  if (is_absent) row.rate_rad_s.fill(std::numeric_limits<float>::quiet_NaN());
}

/// Rest of a nav_msgs/Odometry behind its header.
void take_speed(CdrReader& message, Row& row) {
  constexpr std::size_t kPose = 3 + 4 + 36;
  message.skip_string();
  message.skip_float64(kPose);
  const double forwards = message.float64();
  row.speed_m_s = static_cast<float>(std::hypot(forwards, message.float64()));
}

bool is_database(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return false;  // a pipe is read once only
  std::array<char, kSqliteMagic.size()> magic{};
  std::ifstream{file, std::ios::binary}.read(magic.data(), magic.size());
  return std::string_view{magic.data(), magic.size()} == kSqliteMagic;
}

}  // namespace

using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

/// An SQLite database that is only read. Each function throws Error.
class Database {
 public:
  explicit Database(const std::filesystem::path& file) : file_(file) {
    sqlite3* opened = nullptr;
    const int fault = sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
    handle_.reset(opened);
    if (fault != SQLITE_OK) throw unreadable();
  }

  [[nodiscard]] Statement prepare(const char* sql, std::initializer_list<const char*> texts = {}) {
    sqlite3_stmt* prepared = nullptr;
    const int fault = sqlite3_prepare_v2(handle_.get(), sql, -1, &prepared, nullptr);
    Statement statement{prepared, &sqlite3_finalize};
    if (fault != SQLITE_OK) throw unreadable();
    int index = 0;
    for (const char* text : texts) sqlite3_bind_text(prepared, ++index, text, -1, SQLITE_TRANSIENT);
    return statement;
  }

  /// Moves to the next row of a result; false at its end.
  [[nodiscard]] bool step(const Statement& statement) const {
    const int result = sqlite3_step(statement.get());
    if (result != SQLITE_ROW && result != SQLITE_DONE) throw unreadable();
    return result == SQLITE_ROW;
  }

  /// The first number of a result; 0 where it is empty.
  [[nodiscard]] std::int64_t number(const char* sql,
                                    std::initializer_list<const char*> texts = {}) {
    const Statement statement = prepare(sql, texts);
    return step(statement) ? sqlite3_column_int64(statement.get(), 0) : 0;
  }

 private:
  [[nodiscard]] Error unreadable() const {
    return Error{{file_.string()},
                 sqlite3_errmsg(handle_.get()),
                 "a bag of ROS 2 (rosbag2_storage_sqlite3)",
                 "See whether ros2 bag info reads it; a compressed bag is to be unpacked first."};
  }

  std::filesystem::path file_;
  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> handle_{nullptr, &sqlite3_close};
};

namespace {

/// The topic that is meant: the one named, or the only one with such messages.
std::string choose_topic(const std::filesystem::path& file, Needs needs, const std::string& named) {
  const std::vector<std::string> topics = bag_topics(file, needs);
  const char* const option = needs == Needs::rates ? "--topic" : "--odometry-topic";
  const char* const type = type_names(needs)[0];
  const std::string list = fmt::format("{}", fmt::join(topics, ", "));
  if (topics.empty()) {
    throw Error{{file.string()},
                fmt::format("no topic with messages of {}", type),
                "one such topic",
                "See what the bag holds: ros2 bag info."};
  }
  if (!named.empty() && std::ranges::find(topics, named) == topics.end()) {
    throw Error{{file.string()},
                fmt::format("no topic {} with messages of {}", excerpt(named), type),
                list,
                fmt::format("Name one of them: {}.", option)};
  }
  if (named.empty() && topics.size() > 1) {
    throw Error{{file.string()},
                fmt::format("{} topics with messages of {}", topics.size(), type),
                list,
                fmt::format("Name the one that is meant: {}.", option)};
  }
  return named.empty() ? topics.front() : named;
}

}  // namespace

std::vector<std::filesystem::path> bag_files(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored)) {
    return is_database(path) ? std::vector{path} : std::vector<std::filesystem::path>{};
  }
  std::vector<std::pair<std::int64_t, std::filesystem::path>> found;
  for (const auto& entry : std::filesystem::directory_iterator{path, ignored}) {
    if (entry.path().extension() != ".db3") continue;
    found.emplace_back(Database{entry.path()}.number(kFirstTime), entry.path());
  }
  std::ranges::sort(found);
  std::vector<std::filesystem::path> files;
  files.reserve(found.size());
  for (auto& [time, file] : found) files.push_back(std::move(file));
  return files;
}

std::vector<std::string> bag_topics(const std::filesystem::path& file, Needs needs) {
  Database database{file};
  const auto types = type_names(needs);
  const Statement query = database.prepare(kTopics, {types[0], types[1]});
  std::vector<std::string> topics;
  while (database.step(query)) {
    topics.emplace_back(reinterpret_cast<const char*>(sqlite3_column_text(query.get(), 0)));
  }
  return topics;
}

struct BagRows::OpenFile {
  OpenFile(const std::filesystem::path& file, const std::string& topic)
      : database(file), messages(database.prepare(kMessages, {topic.c_str()})) {}

  Database database;
  Statement messages;
};

BagRows::BagRows(std::vector<std::filesystem::path> files, Needs needs, const std::string& topic)
    : files_(std::move(files)),
      needs_(needs),
      topic_(choose_topic(files_.front(), needs, topic)),
      columns_{.rate_unit = RateUnit::rad_per_s, .speed = needs == Needs::motion} {
  for (const auto& file : files_) {
    messages_known_ += static_cast<std::uint64_t>(Database{file}.number(kCount, {topic_.c_str()}));
  }
  open_next();
}

BagRows::~BagRows() = default;

void BagRows::open_next() {
  open_ = std::make_unique<OpenFile>(files_[opened_], topic_);
  ++opened_;
}

bool BagRows::next(Row& row) {
  while (!open_->database.step(open_->messages)) {
    if (opened_ == files_.size()) {
      if (messages_ > 0) return false;
      throw Error{{files_.front().string()},
                  "no messages of " + topic_,
                  "at least one message",
                  "Check that the bag was recorded to its end."};
    }
    open_next();
  }
  ++messages_;
  sqlite3_stmt* const message = open_->messages.get();
  const auto* const bytes = static_cast<const std::byte*>(sqlite3_column_blob(message, 1));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(message, 1));
  row = decode(sqlite3_column_int64(message, 0), {bytes, size});
  return true;
}

Row BagRows::decode(std::int64_t recorded_ns, std::span<const std::byte> message) const {
  const auto bad = [&](const char* found, const char* expected) {
    return Error{{files_[opened_ - 1].string()},
                 fmt::format("{} as message {} of {}", found, messages_, topic_),
                 expected,
                 "The bag may be damaged, or its type of message another one."};
  };
  Row row;
  try {
    CdrReader reader{message};
    const std::int64_t stamp_ns = take_stamp(reader);
    row.time_ns = stamp_ns != 0 ? stamp_ns : recorded_ns;
    if (needs_ == Needs::rates) {
      take_rates(reader, row);
    } else {
      take_speed(reader, row);
    }
  } catch (const CdrReader::Truncated&) {
    throw bad("a message that ends early", type_names(needs_)[0]);
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
