#include "host_tools/lib/recording/line_reader.hpp"

#include <cstring>
#include <span>

namespace zerorate::recording {
namespace {

constexpr std::size_t kLongestLine = std::size_t{1024} * 1024;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

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
  if (line_ == 0 && line.starts_with(kByteOrderMark)) {
    line.remove_prefix(kByteOrderMark.size());
  }
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
  const std::size_t count = source_.read(std::span{buffer_}.subspan(end_), line_ + 1);
  end_ += count;
  return count != 0;
}

}  // namespace zerorate::recording
