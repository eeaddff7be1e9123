#include "host_tools/lib/recording/byte_source.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <span>
#include <system_error>

namespace zerorate::recording {

namespace {

constexpr std::size_t kInputBytes = std::size_t{256} * 1024;
constexpr int kAnyWindowGzipOnly = 15 + 16;  // zlib.h, inflateInit2

Error unreadable(const std::string& name, std::uint64_t line) {
  return Error{{name, line},
               std::generic_category().message(errno),
               "a file that can be read",
               fmt::format("Check the name and the permissions of {}.", name)};
}

}  // namespace

void ByteSource::Closer::operator()(std::FILE* file) const {
  if (file != stdin) {
    static_cast<void>(std::fclose(file));  // opened for reading: nothing can be lost
  }
}

ByteSource::ByteSource(const std::filesystem::path& path)
    : name_(path == "-" ? "standard input" : path.string()), input_(kInputBytes) {
  std::error_code ignored;
  if (path != "-" && std::filesystem::is_directory(path, ignored)) {
    throw Error{{name_}, "a directory", "a CSV or CSV.gz file", "Name a file inside it."};
  }
  file_.reset(path == "-" ? stdin : std::fopen(path.c_str(), "rb"));
  if (!file_) {
    throw unreadable(name_, 0);
  }
  if (path != "-" && std::filesystem::is_regular_file(path, ignored)) {
    size_ = std::filesystem::file_size(path, ignored);
  }
  constexpr unsigned char kGzipMagic[] = {0x1F, 0x8B};
  if (refill(0) && stream_.avail_in >= 2 &&
      std::equal(kGzipMagic, kGzipMagic + 2, input_.begin())) {
    begin_inflating();
  }
}

ByteSource::~ByteSource() {
  if (inflating_) {
    inflateEnd(&stream_);
  }
}

void ByteSource::begin_inflating() {
  if (inflateInit2(&stream_, kAnyWindowGzipOnly) != Z_OK) {
    throw std::bad_alloc{};
  }
  inflating_ = true;
}

bool ByteSource::refill(std::uint64_t line) {
  const std::size_t count = std::fread(input_.data(), 1, input_.size(), file_.get());
  if (count == 0 && std::ferror(file_.get()) != 0) {
    throw unreadable(name_, line);
  }
  taken_ += count;
  stream_.next_in = input_.data();
  stream_.avail_in = static_cast<uInt>(count);
  return count != 0;
}

std::size_t ByteSource::read(std::span<char> out, std::uint64_t line) {
  return inflating_ ? inflate_into(out, line) : copy_into(out, line);
}

std::size_t ByteSource::copy_into(std::span<char> out, std::uint64_t line) {
  if (stream_.avail_in == 0 && !refill(line)) {
    return 0;
  }
  const std::size_t count = std::min<std::size_t>(out.size(), stream_.avail_in);
  std::memcpy(out.data(), stream_.next_in, count);
  stream_.next_in += count;
  stream_.avail_in -= static_cast<uInt>(count);
  return count;
}

std::size_t ByteSource::inflate_into(std::span<char> out, std::uint64_t line) {
  stream_.next_out = reinterpret_cast<Bytef*>(out.data());
  stream_.avail_out = static_cast<uInt>(out.size());
  while (true) {
    if (between_members_) {
      if (stream_.avail_in == 0 && !refill(line)) {
        return 0;
      }
      inflateReset(&stream_);
      between_members_ = false;
    }
    // Before any refill: zlib may still hold output for input that it has already taken.
    const int status = inflate(&stream_, Z_NO_FLUSH);
    between_members_ = status == Z_STREAM_END;
    if (stream_.avail_out < out.size()) {
      return out.size() - stream_.avail_out;
    }
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) {
      throw Error{{name_, line},
                  fmt::format("damaged gzip data ({})", stream_.msg ? stream_.msg : "no detail"),
                  "an intact gzip file",
                  "Copy the file again; `gzip -t` checks it."};
    }
    if (!between_members_ && stream_.avail_in == 0 && !refill(line)) {
      throw Error{{name_, line},
                  "the end of the file in the middle of its gzip stream",
                  "a whole gzip file",
                  "Copy the file again; `gzip -t` checks it."};
    }
  }
}

std::optional<double> ByteSource::fraction_read() const {
  if (size_ == 0) {
    return std::nullopt;
  }
  const std::uint64_t used = taken_ - stream_.avail_in;
  return std::min(1.0, static_cast<double>(used) / static_cast<double>(size_));
}

namespace {

constexpr std::size_t kLongestLine = std::size_t{1024} * 1024;

}  // namespace

LineReader::LineReader(const std::filesystem::path& path) : source_(path), buffer_(kLongestLine) {}

Place LineReader::place(std::uint64_t column) const {
  return {source_.name(), line_, column};
}

bool LineReader::next(std::string_view& line) {
  std::size_t searched = 0;
  while (true) {
    const char* const from = buffer_.data() + begin_ + searched;
    const auto* const newline =
        static_cast<const char*>(std::memchr(from, '\n', end_ - begin_ - searched));
    if (newline != nullptr) {
      line = take(searched + static_cast<std::size_t>(newline - from), 1);
      return true;
    }
    searched = end_ - begin_;
    if (!fill()) {
      break;
    }
  }
  if (searched == 0) {
    return false;
  }
  is_terminated_ = false;
  line = take(searched, 0);
  return true;
}

std::string_view LineReader::take(std::size_t length, std::size_t end_length) {
  std::string_view line{buffer_.data() + begin_, length};
  begin_ += length + end_length;
  ++line_;
  if (line.ends_with('\r')) {
    line.remove_suffix(1);
  }
  return line;
}

bool LineReader::fill() {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (end_ == buffer_.size()) {
    throw Error{{source_.name(), line_ + 1},
                "a line longer than 1 MiB",
                "a CSV file with one sample a line",
                "Check that this is the right file."};
  }
  const std::size_t count = read(std::span{buffer_}.subspan(end_));
  end_ += count;
  return count != 0;
}

std::size_t LineReader::read(std::span<char> out) {
  while (true) {
    const std::size_t count = source_.read(out, line_ + 1);
    if (count == 0) return 0;
    if (!decoder_) decoder_.emplace(out.first(count));
    if (const std::size_t kept = decoder_->decode(out.first(count)); kept > 0) return kept;
  }
}

std::string_view LineReader::ahead() {
  constexpr std::size_t kAhead = std::size_t{64} * 1024;
  while (end_ - begin_ < kAhead && fill()) {
  }
  return {buffer_.data() + begin_, end_ - begin_};
}

}  // namespace zerorate::recording
