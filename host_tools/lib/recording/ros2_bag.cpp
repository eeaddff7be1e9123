#include <sqlite3.h>

#include <algorithm>
#include <initializer_list>
#include <system_error>
#include <utility>

#include "host_tools/lib/recording/bag.hpp"

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

constexpr BagFormat kRos2Format{.serialization = Serialization::cdr,
                                .name = "a bag of ROS 2",
                                .types = kRos2Types,
                                .info_command = "ros2 bag info"};

using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

/// An SQLite database that is only read. Each function throws Error.
class Database {
 public:
  explicit Database(const std::filesystem::path& file) : file_(file) {
    sqlite3* opened = nullptr;
    const int fault = sqlite3_open_v2(file.c_str(), &opened, SQLITE_OPEN_READONLY, nullptr);
    handle_.reset(opened);
    if (fault != SQLITE_OK) throw unreadable();
    // A view of that name may compute for ever.
    constexpr const char* kTables =
        "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('messages', "
        "'topics')";
    if (number(kTables) != 2) {
      throw Error{{file_.string()},
                  "no tables messages and topics",
                  "a bag of ROS 2 (rosbag2_storage_sqlite3)",
                  "See whether ros2 bag info reads it."};
    }
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

/// The databases of a bag, in the order of their messages: the file itself, or all .db3 files of a
/// folder. Empty where the path is no bag.
std::vector<std::filesystem::path> bag_files(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored)) {
    return file_begins_with(path, kSqliteMagic) ? std::vector{path}
                                                : std::vector<std::filesystem::path>{};
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

/// One topic of the databases of a bag, one database after the other.
class Ros2Bag : public Bag {
 public:
  /// @param files  at least one
  explicit Ros2Bag(std::vector<std::filesystem::path> files) : files_(std::move(files)) {}

  [[nodiscard]] const BagFormat& format() const override { return kRos2Format; }

  [[nodiscard]] std::vector<std::string> topics(MessageType type) override {
    Database database{files_.front()};
    // Bags that were converted from ROS 1 may keep its names.
    const std::string name{kRos2Format.name_of(type)};
    const std::string name_in_ros1{kRos1Types.at(static_cast<std::size_t>(type))};
    const Statement query = database.prepare(kTopics, {name.c_str(), name_in_ros1.c_str()});
    std::vector<std::string> topics;
    while (database.step(query)) {
      topics.emplace_back(reinterpret_cast<const char*>(sqlite3_column_text(query.get(), 0)));
    }
    return topics;
  }

  std::uint64_t select(const std::string& topic, MessageType /*type*/) override {
    topic_ = topic;
    std::int64_t messages = 0;
    for (const auto& file : files_) messages += Database{file}.number(kCount, {topic.c_str()});
    open(0);
    return static_cast<std::uint64_t>(messages);
  }

  [[nodiscard]] bool next(BagMessage& message) override {
    while (!open_->database.step(open_->messages)) {
      if (opened_ + 1 == files_.size()) return false;
      open(opened_ + 1);
    }
    sqlite3_stmt* const row = open_->messages.get();
    const auto* const bytes = static_cast<const std::byte*>(sqlite3_column_blob(row, 1));
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, 1));
    message = {.recorded_ns = sqlite3_column_int64(row, 0), .bytes = {bytes, size}};
    return true;
  }

  [[nodiscard]] const std::filesystem::path& file() const override { return files_[opened_]; }

 private:
  struct OpenFile {
    OpenFile(const std::filesystem::path& file, const std::string& topic)
        : database(file), messages(database.prepare(kMessages, {topic.c_str()})) {}

    Database database;
    Statement messages;
  };

  void open(std::size_t index) {
    open_ = std::make_unique<OpenFile>(files_[index], topic_);
    opened_ = index;
  }

  std::vector<std::filesystem::path> files_;
  std::string topic_;
  std::unique_ptr<OpenFile> open_;
  std::size_t opened_ = 0;  ///< index in the files
};

}  // namespace

std::unique_ptr<Bag> open_ros2_bag(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files = bag_files(path);
  if (files.empty()) return nullptr;
  return std::make_unique<Ros2Bag>(std::move(files));
}

}  // namespace zerorate::recording
