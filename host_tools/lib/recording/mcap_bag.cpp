// A bag of ROS 2 in MCAP (mcap.dev/spec): records, one after the other, some of them in chunks.
#include <fmt/format.h>
#include <zlib.h>
#ifdef ZERORATE_HAS_LZ4
#include <lz4frame.h>
#endif
#ifdef ZERORATE_HAS_ZSTD
#include <zstd.h>
#endif

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "host_tools/lib/recording/bag.hpp"

namespace zerorate::recording {
namespace {

constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};
constexpr BagFormat kMcapFormat{.serialization = Serialization::cdr,
                                .name = "a bag of ROS 2 in MCAP",
                                .types = kRos2Types,
                                .info_command = "ros2 bag info"};

enum class Op : std::uint8_t {
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  data_end = 0x0F
};

struct Damaged {};

/// Fields of a record, little-endian. Each function throws Damaged where the record is too short.
class RecordFields {
 public:
  explicit RecordFields(std::string_view bytes) : left_(bytes) {}

  template <class Unsigned>
  Unsigned number() {
    const std::string_view bytes = take(sizeof(Unsigned));
    Unsigned value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      value |= static_cast<Unsigned>(Unsigned{static_cast<unsigned char>(bytes[i])} << (8 * i));
    }
    return value;
  }
  std::string_view text() { return take(number<std::uint32_t>()); }
  std::string_view take(std::uint64_t count) {
    if (count > left_.size()) throw Damaged{};
    const std::string_view bytes = left_.substr(0, count);
    left_.remove_prefix(count);
    return bytes;
  }
  [[nodiscard]] std::string_view rest() const { return left_; }

 private:
  std::string_view left_;
};

struct Record {
  Op op = Op::footer;
  std::string_view content;  ///< until the next record is read
};

/// Unpacks chunks.
class Unpacker {
 public:
  explicit Unpacker(std::string file) : file_(std::move(file)) {}

  /// Records of a chunk, until the next call. Throws Error and Damaged.
  std::string_view unpack(std::string_view chunk) {
    constexpr std::uint64_t kLargest = 1U << 30U;
    constexpr std::uint64_t kTimes = 16;
    RecordFields fields{chunk};
    fields.take(kTimes);
    const auto size = fields.number<std::uint64_t>();
    const auto checksum = fields.number<std::uint32_t>();
    const std::string_view packing = fields.text();
    const std::string_view packed = fields.take(fields.number<std::uint64_t>());
    if (size > kLargest) throw Damaged{};
    if (packing.empty()) {
      unpacked_ = packed;
    } else {
      unpacked_.resize(size);
      unpack(packing, packed);
    }
    const auto* const bytes = reinterpret_cast<const Bytef*>(unpacked_.data());
    const bool is_right = checksum == 0 || crc32_z(0, bytes, unpacked_.size()) == checksum;
    if (unpacked_.size() != size || !is_right) throw Damaged{};
    return unpacked_;
  }

 private:
  void unpack(std::string_view packing, [[maybe_unused]] std::string_view packed) {
#ifdef ZERORATE_HAS_LZ4
    if (packing == "lz4") return unpack_lz4(packed);
#endif
#ifdef ZERORATE_HAS_ZSTD
    if (packing == "zstd") return unpack_zstd(packed);
#endif
    throw Error{{file_},
                fmt::format("a chunk that is compressed by {}", excerpt(packing)),
                "chunks without compression, or lz4 and zstd where zerorate was built with them",
                "Build with liblz4-dev and libzstd-dev, or convert the bag: mcap compress "
                "--compression none run.mcap -o plain.mcap."};
  }
#ifdef ZERORATE_HAS_LZ4
  void unpack_lz4(std::string_view packed) {
    LZ4F_dctx* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) throw Damaged{};
    std::size_t written = 0;
    std::size_t result = 1;
    while (result != 0 && !packed.empty()) {
      std::size_t size = unpacked_.size() - written;
      std::size_t taken = packed.size();
      result = LZ4F_decompress(context, unpacked_.data() + written, &size, packed.data(), &taken,
                               nullptr);
      if (LZ4F_isError(result) != 0 || (size == 0 && taken == 0)) break;
      written += size;
      packed.remove_prefix(taken);
    }
    LZ4F_freeDecompressionContext(context);
    if (result != 0 || written != unpacked_.size()) throw Damaged{};
  }
#endif
#ifdef ZERORATE_HAS_ZSTD
  void unpack_zstd(std::string_view packed) {
    const std::size_t written =
        ZSTD_decompress(unpacked_.data(), unpacked_.size(), packed.data(), packed.size());
    if (ZSTD_isError(written) != 0 || written != unpacked_.size()) throw Damaged{};
  }
#endif

  std::string file_;
  std::string unpacked_;
};

/// Reads the records of a file up to the end of its data, those of chunks in their places.
class RecordReader {
 public:
  /// Throws Error.
  explicit RecordReader(const std::filesystem::path& path)
      : path_(path), file_(path, std::ios::binary), unpacker_(path.string()) {
    std::error_code fault;
    size_ = std::filesystem::file_size(path, fault);
    if (fault || !file_) throw bad("a file that cannot be read", "Check its rights.");
    file_.seekg(static_cast<std::streamoff>(kMagic.size()));
    place_ = kMagic.size();
  }

  /// False behind the last record of the data. Throws Error.
  bool next(Record& record) {
    const std::uint64_t begin = place_;
    try {
      while (in_chunk_.empty()) {
        record = take_from_file();
        if (record.op == Op::data_end || record.op == Op::footer) return false;
        if (record.op != Op::chunk) return true;
        in_chunk_ = unpacker_.unpack(record.content);
      }
      RecordFields fields{in_chunk_};
      record.op = static_cast<Op>(fields.number<std::uint8_t>());
      record.content = fields.take(fields.number<std::uint64_t>());
      in_chunk_ = fields.rest();
      return true;
    } catch (const Damaged&) {
      throw damaged(begin);
    }
  }

  /// Error of a damaged record that next() gave.
  /// @param place  place() before that call
  [[nodiscard]] Error damaged(std::uint64_t place) const {
    return bad(fmt::format("a damaged record behind byte {}", place), kRecover);
  }
  [[nodiscard]] std::uint64_t place() const { return place_; }

 private:
  static constexpr std::uint64_t kHead = 9;  ///< kind and length of a record
  static constexpr const char* kRecover = "Try to mend it: mcap recover run.mcap -o mended.mcap.";

  Record take_from_file() {
    const std::string head = bytes(kHead);
    RecordFields fields{head};
    Record record{.op = static_cast<Op>(fields.number<std::uint8_t>()), .content = {}};
    const auto length = fields.number<std::uint64_t>();
    if (length > size_ - place_) throw ends_early();
    if (!is_read(record.op)) {
      place_ += length;
      file_.seekg(static_cast<std::streamoff>(place_));
      return record;
    }
    content_ = bytes(length);
    record.content = content_;
    return record;
  }

  static bool is_read(Op op) { return op >= Op::schema && op <= Op::chunk; }

  std::string bytes(std::uint64_t count) {
    if (count > size_ - place_) throw ends_early();
    std::string bytes(count, '\0');
    file_.read(bytes.data(), static_cast<std::streamsize>(count));
    if (!file_) throw ends_early();
    place_ += count;
    return bytes;
  }

  [[nodiscard]] Error bad(std::string found, const char* mend) const {
    return Error{{path_.string()}, std::move(found), "a whole bag in MCAP", mend};
  }
  [[nodiscard]] Error ends_early() const { return bad("a bag that ends early", kRecover); }

  std::filesystem::path path_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::uint64_t place_ = 0;
  std::string content_;
  Unpacker unpacker_;
  std::string_view in_chunk_;  ///< records of the chunk that are left
};

/// Reads messages in CDR with their topics and types.
class MessageReader {
 public:
  struct Channel {
    std::string topic;
    std::string type;
  };

  explicit MessageReader(const std::filesystem::path& path) : records_(path) {}

  /// Moves to the next message; null at the end. Throws Error.
  const Channel* next(BagMessage& message) {
    Record record;
    std::uint64_t place = records_.place();
    for (; records_.next(record); place = records_.place()) {
      try {
        if (const Channel* const channel = take(record, message)) return channel;
      } catch (const Damaged&) {
        throw records_.damaged(place);
      }
    }
    return nullptr;
  }

 private:
  const Channel* take(const Record& record, BagMessage& message) {
    RecordFields fields{record.content};
    switch (record.op) {
      case Op::schema: {
        const auto id = fields.number<std::uint16_t>();
        schemas_[id] = fields.text();
        return nullptr;
      }
      case Op::channel:
        take_channel(fields);
        return nullptr;
      case Op::message:
        return take_message(fields, message);
      default:
        return nullptr;
    }
  }

  void take_channel(RecordFields& fields) {
    const auto id = fields.number<std::uint16_t>();
    const auto schema = fields.number<std::uint16_t>();
    const std::string_view topic = fields.text();
    if (fields.text() == "cdr") channels_[id] = {std::string(topic), schemas_[schema]};
  }

  const Channel* take_message(RecordFields& fields, BagMessage& message) {
    constexpr std::size_t kSequence = 4;
    constexpr std::size_t kPublishTime = 8;
    const auto found = channels_.find(fields.number<std::uint16_t>());
    if (found == channels_.end()) return nullptr;
    fields.take(kSequence);
    message.recorded_ns = static_cast<std::int64_t>(fields.number<std::uint64_t>());
    fields.take(kPublishTime);
    const std::string_view bytes = fields.rest();
    message.bytes = std::as_bytes(std::span{bytes.data(), bytes.size()});
    return &found->second;
  }

  RecordReader records_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

/// Reads one topic of a bag, one file after the other.
class McapBag : public Bag {
 public:
  explicit McapBag(const std::vector<std::filesystem::path>& paths) {
    std::vector<std::pair<std::int64_t, std::filesystem::path>> found;
    found.reserve(paths.size());
    for (const auto& path : paths) found.emplace_back(look_through(path), path);
    std::ranges::sort(found);
    files_.reserve(found.size());
    for (auto& [time, path] : found) files_.push_back(std::move(path));
  }

  [[nodiscard]] const BagFormat& format() const override { return kMcapFormat; }

  [[nodiscard]] std::vector<std::string> topics(MessageType type) override {
    const auto index = static_cast<std::size_t>(type);
    std::vector<std::string> names;
    for (const auto& [channel, messages] : counts_) {
      if (channel.second == kRos2Types.at(index) || channel.second == kRos1Types.at(index)) {
        names.push_back(channel.first);
      }
    }
    return names;
  }

  std::uint64_t select(const std::string& topic, MessageType /*type*/) override {
    topic_ = topic;
    std::uint64_t messages = 0;
    for (const auto& [channel, count] : counts_) messages += channel.first == topic ? count : 0;
    open(0);
    return messages;
  }

  [[nodiscard]] bool next(BagMessage& message) override {
    for (;;) {
      while (const auto* const channel = open_->next(message)) {
        if (channel->topic == topic_) return true;
      }
      if (opened_ + 1 == files_.size()) return false;
      open(opened_ + 1);
    }
  }

  [[nodiscard]] const std::filesystem::path& file() const override { return files_[opened_]; }

 private:
  /// Counts the messages of a file.
  /// @return time of the first one
  std::int64_t look_through(const std::filesystem::path& path) {
    MessageReader reader{path};
    BagMessage message;
    std::optional<std::int64_t> first_ns;
    while (const auto* const channel = reader.next(message)) {
      ++counts_[{channel->topic, channel->type}];
      if (!first_ns) first_ns = message.recorded_ns;
    }
    return first_ns.value_or(0);
  }

  void open(std::size_t index) {
    open_ = std::make_unique<MessageReader>(files_[index]);
    opened_ = index;
  }

  std::vector<std::filesystem::path> files_;
  std::map<std::pair<std::string, std::string>, std::uint64_t>
      counts_;  ///< number of messages by topic and type
  std::string topic_;
  std::unique_ptr<MessageReader> open_;
  std::size_t opened_ = 0;  ///< index of the open file
};

}  // namespace

std::unique_ptr<Bag> open_mcap_bag(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    for (const auto& entry : std::filesystem::directory_iterator{path, ignored}) {
      if (entry.path().extension() == ".mcap" && file_begins_with(entry.path(), kMagic)) {
        files.push_back(entry.path());
      }
    }
  } else if (file_begins_with(path, kMagic)) {
    files.push_back(path);
  }
  if (files.empty()) return nullptr;
  return std::make_unique<McapBag>(files);
}

}  // namespace zerorate::recording
