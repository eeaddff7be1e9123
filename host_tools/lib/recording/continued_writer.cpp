#include "host_tools/lib/recording/continued_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <memory>
#include <new>
#include <system_error>
#include <vector>

#include "host_tools/lib/recording/header.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/recording/writer.hpp"

namespace zerorate::recording {
namespace {

constexpr int kGzipOnly = 15 + 16;  // zlib.h, deflateInit2 and inflateInit2
constexpr std::size_t kChunkBytes = std::size_t{64} * 1024;

/// A z_stream that is ended by the function that fits it.
struct Stream {
  explicit Stream(int (*end)(z_streamp)) : end_(end) {}
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() { end_(&z); }

  z_stream z{};

 private:
  int (*end_)(z_streamp);
};

/// Bytes of the file up to the end of its last whole gzip member.
std::uint64_t whole_members(int file) {
  Stream stream{inflateEnd};
  if (inflateInit2(&stream.z, kGzipOnly) != Z_OK) throw std::bad_alloc{};
  std::vector<unsigned char> in(kChunkBytes);
  std::vector<unsigned char> out(kChunkBytes);
  std::uint64_t read_bytes = 0;
  std::uint64_t whole = 0;
  for (ssize_t count = 0;
       (count = pread(file, in.data(), in.size(), static_cast<off_t>(read_bytes))) > 0;) {
    read_bytes += static_cast<std::uint64_t>(count);
    stream.z.next_in = in.data();
    stream.z.avail_in = static_cast<uInt>(count);
    do {
      stream.z.next_out = out.data();
      stream.z.avail_out = static_cast<uInt>(out.size());
      const int status = inflate(&stream.z, Z_NO_FLUSH);
      if (status == Z_STREAM_END) {
        whole = read_bytes - stream.z.avail_in;
        inflateReset(&stream.z);
      } else if (status != Z_OK && status != Z_BUF_ERROR) {
        return whole;
      }
    } while (stream.z.avail_in > 0 || stream.z.avail_out == 0);
  }
  return whole;
}

/// Bytes of the file up to the end of its last whole line.
std::uint64_t whole_lines(int file, std::uint64_t size) {
  std::vector<char> bytes(kChunkBytes);
  while (size > 0) {
    const std::uint64_t begin = size > kChunkBytes ? size - kChunkBytes : 0;
    const ssize_t count = pread(file, bytes.data(), size - begin, static_cast<off_t>(begin));
    if (count <= 0) return 0;
    for (auto at = static_cast<std::uint64_t>(count); at > 0; --at) {
      if (bytes[at - 1] == '\n') return begin + at;
    }
    size = begin;
  }
  return 0;
}

}  // namespace

ContinuedWriter::ContinuedWriter(const std::filesystem::path& path, const Columns& columns,
                                 std::string_view comment)
    : path_(path), is_packed_(path.extension() == ".gz"), columns_(columns) {
  open(O_CREAT | O_EXCL);
  text_ = fmt::format("# {}\n{}\n", comment, header_line(columns_));
}

ContinuedWriter::ContinuedWriter(const std::filesystem::path& path)
    : path_(path), is_packed_(path.extension() == ".gz") {
  open(0);
  cut_off_torn_part();
  read_held();
}

void ContinuedWriter::open(int flags) {
  constexpr mode_t kLessUmask = 0666;
  file_ = hal::linux_os::Descriptor{
      ::open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK | flags, kLessUmask)};
  struct stat status {};
  if (!file_.is_open() || fstat(file_.get(), &status) != 0) throw cannot("open", errno);
  if (!S_ISREG(status.st_mode)) {
    throw Error{{path_.string()}, "no regular file", "a file to write", "Choose another name."};
  }
  if (flock(file_.get(), LOCK_EX | LOCK_NB) != 0) {
    throw Error{{path_.string()},
                "that another program records to it",
                "a file of its own",
                "End the other recording, or choose another name."};
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

void ContinuedWriter::append_to_text(const Row& row) {
  append_row(text_, columns_, row);
}

void ContinuedWriter::cut_off_torn_part() {
  const std::uint64_t whole =
      is_packed_ ? whole_members(file_.get()) : whole_lines(file_.get(), size_);
  if (whole == 0) {
    throw Error{{path_.string()},
                "no whole part of a recording",
                "a recording to go on with",
                "Remove the file and begin anew."};
  }
  held_.torn_bytes = size_ - whole;
  if (held_.torn_bytes > 0 && ftruncate(file_.get(), static_cast<off_t>(whole)) != 0) {
    throw cannot("shorten", errno);
  }
  size_ = whole;
}

void ContinuedWriter::read_held() {
  Reader reader{path_};
  if (!reader.ignored_columns().empty()) {
    throw Error{{path_.string()},
                "columns that a recording does not have",
                "a file that zerorate record wrote",
                "Choose another name."};
  }
  columns_ = reader.columns();
  for (Row row; reader.next(row);) {
    const std::int64_t interval_ns = row.time_ns - held_.last_time_ns;
    if (held_.rows > 0 && interval_ns > 0 && interval_ns <= kLongestInterval_ns) {
      held_.recorded_ns += interval_ns;
    }
    ++held_.rows;
    held_.last_time_ns = row.time_ns;
    held_.last_odometer_pulses = row.odometer_pulses;
  }
}

std::string ContinuedWriter::packed() const {
  Stream stream{deflateEnd};
  constexpr int kMemoryLevel = 8;  // zlib's default
  if (deflateInit2(&stream.z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipOnly, kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc{};
  }
  std::string member(deflateBound(&stream.z, text_.size()), '\0');
  // zlib does not write to its input; its type says otherwise for old C.
  stream.z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text_.data()));  // NOLINT
  stream.z.avail_in = static_cast<uInt>(text_.size());
  stream.z.next_out = reinterpret_cast<Bytef*>(member.data());
  stream.z.avail_out = static_cast<uInt>(member.size());
  (void)deflate(&stream.z, Z_FINISH);
  member.resize(stream.z.total_out);
  return member;
}

void ContinuedWriter::flush() {
  if (text_.empty()) return;
  const std::string part = is_packed_ ? packed() : text_;
  for (std::size_t written = 0; written < part.size();) {
    const ssize_t count = pwrite(file_.get(), part.data() + written, part.size() - written,
                                 static_cast<off_t>(size_ + written));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const int reason = errno;
      (void)!ftruncate(file_.get(), static_cast<off_t>(size_));
      throw cannot("write", reason);
    }
    written += static_cast<std::size_t>(count);
  }
  if (fdatasync(file_.get()) != 0 && errno != EINVAL) throw cannot("write", errno);
  size_ += part.size();
  text_.clear();
}

Error ContinuedWriter::cannot(std::string_view action, int error_number) const {
  if (error_number == EEXIST) {
    return Error{{path_.string()},
                 "a file of this name",
                 "a new name",
                 "Choose another name, or go on with this file: --resume."};
  }
  return Error{{path_.string()},
               fmt::format("that it cannot {} the file ({})", action,
                           std::generic_category().message(error_number)),
               "a file name in a folder with space and permission to write",
               "Check the folder, the disk and the permissions."};
}

}  // namespace zerorate::recording
