// Compiled only where Debian's librosbag-storage is installed.
#include <fmt/format.h>
#include <rosbag/bag.h>
#include <rosbag/constants.h>
#include <rosbag/stream.h>
#include <rosbag/view.h>

#include <exception>
#include <fstream>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "host_tools/lib/recording/bag.hpp"

namespace zerorate::recording {
namespace {

constexpr BagFormat kRos1Format{.serialization = Serialization::ros1,
                                .name = "a bag of ROS 1",
                                .types = kRos1Types,
                                .info_command = "rosbag info"};
constexpr std::string_view kVersionLine = "#ROSBAG V2.0\n";
constexpr const char* kReindex = "Try to mend it: rosbag reindex.";

Error bad_bag(const std::filesystem::path& path, std::string found, const char* mend = kReindex) {
  return Error{{path.string()}, std::move(found), "a whole bag of ROS 1", mend};
}

/// Where a header lacks a field, 0.
template <class Unsigned>
Unsigned little_endian(std::string_view bytes) {
  Unsigned value = 0;
  if (bytes.size() != sizeof value) return value;
  for (std::size_t i = 0; i < sizeof value; ++i) {
    value |= static_cast<Unsigned>(Unsigned{static_cast<unsigned char>(bytes[i])} << (8 * i));
  }
  return value;
}

/// Looks through the records of a bag (ROS wiki, Bags/Format/2.0) before the library does, which
/// follows the places and lengths that a damaged bag states out of its memory. A compressed chunk
/// is unpacked for that.
class RecordCheck {
 public:
  /// Throws Error.
  explicit RecordCheck(const std::filesystem::path& path)
      : path_(path), file_(path, std::ios::binary) {
    std::error_code fault;
    size_ = std::filesystem::file_size(path, fault);
    if (fault || !file_) throw bad_bag(path_, "a file that cannot be read", "Check its rights.");
  }

  /// Throws Error for a bag that is not whole.
  void run() {
    if (bytes_at(0, kVersionLine.size()) != kVersionLine) {
      throw bad_bag(path_, "another version of the format than 2.0",
                    "See whether rosbag info reads it.");
    }
    const Record header = record_at(kVersionLine.size(), size_);
    if (header.op != Op::file_header) throw damaged(kVersionLine.size());
    index_place_ = header.index_place;
    if (index_place_ == 0) throw bad_bag(path_, "a bag without an index: it was not closed");
    if (index_place_ > size_) throw ends_early();
    bool has_index = index_place_ == size_;
    Record record;
    for (std::uint64_t place = header.end; place < size_; place = record.end) {
      has_index = has_index || place == index_place_;
      record = record_at(place, size_);
      examine(place, record);
    }
    if (!has_index) throw damaged(index_place_);
  }

 private:
  enum class Op : std::uint8_t {
    none = 0,
    message = 2,
    file_header = 3,
    index = 4,
    chunk = 5,
    chunk_info = 6,
    connection = 7
  };

  struct Record {
    Op op = Op::none;
    std::uint64_t data = 0;  ///< its place in the file
    std::uint64_t end = 0;
    std::uint64_t index_place = 0;  ///< place in the file header
    std::uint64_t chunk_place = 0;  ///< place in a chunk info
    std::uint32_t count = 0;        ///< count of an index or a chunk info
    std::uint32_t size = 0;         ///< size of a chunk when unpacked
    std::string packing;            ///< compression of a chunk, e.g. "lz4"

    [[nodiscard]] std::uint64_t data_size() const { return end - data; }
    [[nodiscard]] bool is_packed() const {
      return !packing.empty() && packing != rosbag::COMPRESSION_NONE;
    }
  };

  void examine(std::uint64_t place, const Record& record) {
    constexpr std::uint64_t kChunkInfoEntry = 8;
    switch (record.op) {
      case Op::chunk:
        if (!record.is_packed() && record.size != record.data_size()) throw damaged(place);
        chunks_.insert(place);
        chunk_ = record;
        if (record.is_packed()) unpacked_ = unpack(place, record);
        break;
      case Op::index:
        if (record.data_size() != record.count * kIndexEntry) throw damaged(place);
        examine_index(record);
        break;
      case Op::chunk_info:
        if (record.data_size() != record.count * kChunkInfoEntry ||
            !chunks_.contains(record.chunk_place)) {
          throw damaged(place);
        }
        break;
      case Op::connection:
        break;
      default:
        throw damaged(place);
    }
  }

  /// Follows each entry to its message in the chunk before.
  void examine_index(const Record& index) {
    constexpr std::size_t kOffset = 8;  // behind the time
    const std::string entries{bytes_at(index.data, index.data_size())};
    for (std::size_t at = 0; at < entries.size(); at += kIndexEntry) {
      const auto offset =
          little_endian<std::uint32_t>(std::string_view{entries}.substr(at + kOffset, 4));
      if (!chunk_ || offset >= chunk_->size) throw leads_astray(index.data + at);
      const bool leads_to_message = chunk_->is_packed()
                                        ? is_message(std::string_view{unpacked_}.substr(offset))
                                        : is_message_at(chunk_->data + offset, chunk_->end);
      if (!leads_to_message) throw leads_astray(index.data + at);
    }
  }

  /// True if a message stands at a place of the file, maybe behind connections.
  bool is_message_at(std::uint64_t place, std::uint64_t limit) {
    Record record;
    do {
      record = record_at(place, limit);
      place = record.end;
    } while (record.op == Op::connection);
    return record.op == Op::message;
  }

  /// True if bytes of an unpacked chunk begin with a message, maybe behind connections.
  static bool is_message(std::string_view chunk) {
    std::optional<Record> record = first_record(chunk);
    while (record && record->op == Op::connection) {
      chunk.remove_prefix(record->end);
      record = first_record(chunk);
    }
    return record && record->op == Op::message;
  }

  static std::optional<Record> first_record(std::string_view chunk) {
    Record record;
    const auto length_at = [&](std::uint64_t place) -> std::uint64_t {
      return little_endian<std::uint32_t>(chunk.substr(std::min(place, chunk.size()), kLength));
    };
    record.data = kLength + length_at(0) + kLength;
    if (record.data > chunk.size()) return std::nullopt;
    record.end = record.data + length_at(record.data - kLength);
    const bool is_whole = record.end <= chunk.size() &&
                          take_fields(chunk.substr(kLength, record.data - 2 * kLength), record);
    return is_whole ? std::optional{record} : std::nullopt;
  }

  /// Bytes of a compressed chunk.
  std::string unpack(std::uint64_t place, const Record& chunk) {
    std::string packed{bytes_at(chunk.data, chunk.data_size())};
    const auto bytes_of = [](std::string& text) {
      return reinterpret_cast<std::uint8_t*>(text.data());
    };
    try {
      std::string bytes(chunk.size, '\0');
      const auto type = chunk.packing == rosbag::COMPRESSION_LZ4 ? rosbag::compression::LZ4
                                                                 : rosbag::compression::BZ2;
      rosbag::StreamFactory{nullptr}.getStream(type)->decompress(
          bytes_of(bytes), chunk.size, bytes_of(packed), static_cast<unsigned>(packed.size()));
      return bytes;
    } catch (const std::exception& error) {
      throw bad_bag(path_, fmt::format("a damaged chunk at byte {} ({})", place, error.what()));
    }
  }

  /// The record at a place, which ends before `limit`.
  Record record_at(std::uint64_t place, std::uint64_t limit) {
    Record record;
    const std::uint64_t fields = place + kLength;
    const std::uint64_t fields_end = fields + length_at(place, limit);
    record.data = fields_end + kLength;
    record.end = record.data + length_at(fields_end, limit);
    if (record.end > limit) throw limit == size_ ? ends_early() : damaged(place);
    if (!take_fields(bytes_at(fields, fields_end - fields), record)) throw damaged(place);
    return record;
  }

  /// False if the fields of a header do not fit into it.
  static bool take_fields(std::string_view left, Record& record) {
    while (!left.empty()) {
      const auto length = little_endian<std::uint32_t>(left.substr(0, kLength));
      const std::size_t equals = left.find('=', kLength);
      if (length > left.size() - std::min(kLength, left.size()) || equals >= kLength + length) {
        return false;
      }
      take(left.substr(kLength, equals - kLength),
           left.substr(equals + 1, kLength + length - equals - 1), record);
      left.remove_prefix(kLength + length);
    }
    return true;
  }

  static void take(std::string_view name, std::string_view value, Record& record) {
    if (name == "op") record.op = static_cast<Op>(little_endian<std::uint8_t>(value));
    if (name == "index_pos") record.index_place = little_endian<std::uint64_t>(value);
    if (name == "chunk_pos") record.chunk_place = little_endian<std::uint64_t>(value);
    if (name == "count") record.count = little_endian<std::uint32_t>(value);
    if (name == "size") record.size = little_endian<std::uint32_t>(value);
    if (name == "compression") record.packing = value;
  }

  /// The length that stands at a place.
  std::uint64_t length_at(std::uint64_t place, std::uint64_t limit) {
    if (place > limit || limit - place < kLength) throw ends_early();
    return little_endian<std::uint32_t>(bytes_at(place, kLength));
  }

  /// Bytes of the file, until the next call.
  std::string_view bytes_at(std::uint64_t place, std::uint64_t count) {
    constexpr std::uint64_t kWindow = 1U << 16U;
    if (place > size_ || count > size_ - place) throw ends_early();
    if (place < window_place_ || place + count > window_place_ + window_.size()) {
      window_.resize(std::min(std::max(kWindow, count), size_ - place));
      window_place_ = place;
      file_.seekg(static_cast<std::streamoff>(place));
      file_.read(window_.data(), static_cast<std::streamsize>(window_.size()));
      if (!file_) throw ends_early();
    }
    return std::string_view{window_}.substr(place - window_place_, count);
  }

  [[nodiscard]] Error ends_early() const { return bad_bag(path_, "a bag that ends early"); }
  [[nodiscard]] Error damaged(std::uint64_t place) const {
    return bad_bag(path_, fmt::format("a damaged record at byte {}", place));
  }
  [[nodiscard]] Error leads_astray(std::uint64_t place) const {
    return bad_bag(path_, fmt::format("an index entry at byte {} that leads to no message", place));
  }

  static constexpr std::size_t kLength = 4;
  static constexpr std::size_t kIndexEntry = 12;

  std::filesystem::path path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::string window_;
  std::uint64_t window_place_ = 0;
  std::uint64_t index_place_ = 0;
  std::set<std::uint64_t> chunks_;
  std::optional<Record> chunk_;  ///< the last one
  std::string unpacked_;         ///< bytes of the last compressed one
};

/// Takes the bytes of a message from the library.
class ByteStream {
 public:
  std::uint8_t* advance(std::uint32_t count) {
    bytes_.resize(count);
    return bytes_.data();
  }
  void clear() { bytes_.clear(); }
  [[nodiscard]] std::span<const std::byte> bytes() const {
    return std::as_bytes(std::span{bytes_});
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

class Ros1Bag : public Bag {
 public:
  explicit Ros1Bag(std::filesystem::path path) : path_(std::move(path)) {
    RecordCheck{path_}.run();
    guarded([&] { bag_.open(path_.string()); });
  }

  [[nodiscard]] const BagFormat& format() const override { return kRos1Format; }

  [[nodiscard]] std::vector<std::string> topics(MessageType type) override {
    std::set<std::string> topics;
    guarded([&] {
      rosbag::View everything{bag_};
      for (const rosbag::ConnectionInfo* connection : everything.getConnections()) {
        if (connection->datatype == kRos1Format.name_of(type)) topics.insert(connection->topic);
      }
    });
    return {topics.begin(), topics.end()};
  }

  std::uint64_t select(const std::string& topic, MessageType type) override {
    std::uint64_t messages = 0;
    guarded([&] {
      view_.emplace(bag_, [=](const rosbag::ConnectionInfo* connection) {
        return connection->topic == topic && connection->datatype == kRos1Format.name_of(type);
      });
      messages = view_->size();
      message_ = view_->begin();
    });
    return messages;
  }

  [[nodiscard]] bool next(BagMessage& message) override {
    if (message_ == view_->end()) return false;
    guarded([&] {
      bytes_.clear();
      message_->write(bytes_);
      message = {.recorded_ns = static_cast<std::int64_t>(message_->getTime().toNSec()),
                 .bytes = bytes_.bytes()};
      ++message_;
    });
    return true;
  }

  [[nodiscard]] const std::filesystem::path& file() const override { return path_; }

 private:
  /// Calls the library, and turns its exceptions into an Error.
  template <class Call>
  void guarded(Call call) const {
    try {
      call();
    } catch (const std::exception& error) {
      throw bad_bag(path_, fmt::format("what librosbag-storage cannot read ({})", error.what()));
    }
  }

  std::filesystem::path path_;
  rosbag::Bag bag_;
  std::optional<rosbag::View> view_;
  rosbag::View::iterator message_;
  ByteStream bytes_;
};

}  // namespace

std::unique_ptr<Bag> open_ros1_bag(const std::filesystem::path& path) {
  return std::make_unique<Ros1Bag>(path);
}

}  // namespace zerorate::recording
