#include "host_tools/lib/recording/writer.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <memory>
#include <new>
#include <system_error>
#include <utility>
#include <vector>

#include "host_tools/lib/recording/number.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::recording {

namespace {

constexpr std::size_t kTextBytes = std::size_t{64} * 1024;

void refuse_special_file(const std::filesystem::path& path) {
  const std::filesystem::file_status status = std::filesystem::status(path);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw Error{{path.string()},
                "a directory or a device",
                "the name of a file to write",
                "Choose another name."};
  }
}

std::error_code last_fault() {
  return {errno, std::generic_category()};
}

/// The fewest digits, from six, that the reader turns into the same float again. Found by trying:
/// a rate in deg/s is not a float, so the shortest form of a float is not its shortest form.
void append_measured(std::string& text, float value, double si_per_unit) {
  const double in_file = static_cast<double>(value) / si_per_unit;
  const std::size_t begin = text.size();
  for (int digits = 6; digits <= 17; ++digits) {
    text.resize(begin);
    fmt::format_to(std::back_inserter(text), ",{:.{}g}", in_file, digits);
    const auto read = parse_real(std::string_view{text}.substr(begin + 1));
    if (!std::isfinite(in_file) || to_si(*read, si_per_unit) == value) {
      return;
    }
  }
}

std::string header_line(const Columns& columns) {
  const std::string_view unit = columns.rate_unit == RateUnit::deg_per_s ? "dps" : "radps";
  std::string line = "t_s";
  if (columns.axis_count == 1) {
    line += fmt::format(",rate_{}", unit);
  } else {
    line += fmt::format(",gx_{0},gy_{0},gz_{0}", unit);
  }
  line += columns.temperature ? ",temp_c" : "";
  line += columns.acceleration ? ",ax_mps2,ay_mps2,az_mps2" : "";
  line += columns.odometer ? ",odometer_pulses" : "";
  line += columns.still ? ",still" : "";
  line += columns.ref_heading ? ",ref_heading_deg" : "";
  line += columns.ref_rate ? ",ref_rate_dps" : "";
  line += columns.ref_speed ? ",ref_speed_mps" : "";
  return line;
}

}  // namespace

void append_row(std::string& text, const Columns& columns, const Row& row) {
  append_seconds(text, row.time_ns);
  for (std::size_t axis = 0; axis < columns.axis_count; ++axis) {
    append_measured(text, row.rate_rad_s[axis], rad_per_s_in(columns.rate_unit));
  }
  if (columns.temperature) append_measured(text, row.temperature_degc, 1.0);
  if (columns.acceleration) {
    for (const float along : row.acceleration_m_s2) append_measured(text, along, 1.0);
  }
  if (columns.odometer) fmt::format_to(std::back_inserter(text), ",{}", row.odometer_pulses);
  if (columns.still) fmt::format_to(std::back_inserter(text), ",{:d}", row.still);
  const double rad_per_deg = rad_per_s_in(RateUnit::deg_per_s);
  if (columns.ref_heading) append_measured(text, row.ref_heading_rad, rad_per_deg);
  if (columns.ref_rate) append_measured(text, row.ref_rate_rad_s, rad_per_deg);
  if (columns.ref_speed) append_measured(text, row.ref_speed_m_s, 1.0);
  text += '\n';
}

Writer::Writer(const std::filesystem::path& path, const Columns& columns)
    : path_(path), columns_(columns) {
  refuse_special_file(path);
  try {
    file_.emplace(path);
  } catch (const std::system_error& error) {
    throw cannot("create", error.code());
  }
  const bool compress = path.extension() == ".gz";
  // zlib closes its descriptor. T: it copies as it is.
  compressor_.reset(gzdopen(::dup(file_->descriptor()), compress ? "wb1" : "wbT"));
  if (!compressor_) {
    throw cannot("create", last_fault());
  }
  text_.reserve(kTextBytes + 256);
  text_.append(header_line(columns_)).append("\n");
}

void Writer::write(const Row& row) {
  append_row(text_, columns_, row);
  if (text_.size() >= kTextBytes) {
    flush();
  }
}

void Writer::flush() {
  if (!text_.empty() &&
      gzwrite(compressor_.get(), text_.data(), static_cast<unsigned>(text_.size())) == 0) {
    throw cannot("write", last_fault());
  }
  text_.clear();
}

void Writer::finish() {
  flush();
  if (gzclose(compressor_.release()) != Z_OK) {
    throw cannot("complete", last_fault());
  }
  try {
    file_->finish();
  } catch (const std::system_error& error) {
    throw cannot("replace", error.code());
  }
}

Error Writer::cannot(std::string_view action, const std::error_code& fault) const {
  return Error{{path_.string()},
               fmt::format("that it cannot {} the file ({})", action, fault.message()),
               "a file name in a folder with space and permission to write",
               "Check the folder, the disk and the permissions."};
}

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
  open(output::AppendedFile::Begin::anew);
  text_ = fmt::format("# {}\n{}\n", comment, header_line(columns_));
}

ContinuedWriter::ContinuedWriter(const std::filesystem::path& path)
    : path_(path), is_packed_(path.extension() == ".gz") {
  open(output::AppendedFile::Begin::at_the_end);
  cut_off_torn_part();
  read_held();
}

void ContinuedWriter::open(output::AppendedFile::Begin begin) {
  try {
    file_.emplace(path_, begin);
  } catch (const std::system_error& fault) {
    throw cannot("open", fault.code());
  }
}

void ContinuedWriter::append_to_text(const Row& row) {
  append_row(text_, columns_, row);
}

void ContinuedWriter::cut_off_torn_part() {
  const std::uint64_t whole = is_packed_ ? whole_members(file_->descriptor())
                                         : whole_lines(file_->descriptor(), file_->size());
  if (whole == 0) {
    throw Error{{path_.string()},
                "no whole part of a recording",
                "a recording to go on with",
                "Remove the file and begin anew."};
  }
  held_.torn_bytes = file_->size() - whole;
  if (held_.torn_bytes == 0) return;
  try {
    file_->cut_to(whole);
  } catch (const std::system_error& fault) {
    throw cannot("shorten", fault.code());
  }
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
  // zlib does not write to its input; the type lacks a const for old C.
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
  try {
    file_->append(is_packed_ ? packed() : text_);
  } catch (const std::system_error& fault) {
    throw cannot("write", fault.code());
  }
  text_.clear();
}

Error ContinuedWriter::cannot(std::string_view action, const std::error_code& fault) const {
  if (fault == std::errc::file_exists) {
    return Error{{path_.string()},
                 "a file of this name",
                 "a new name",
                 "Choose another name, or go on with this file: --resume."};
  }
  if (fault == std::errc::text_file_busy) {
    return Error{{path_.string()},
                 "that another program records to it",
                 "a file of its own",
                 "End the other recording, or choose another name."};
  }
  if (fault == std::errc::invalid_seek) {
    return Error{{path_.string()}, "no regular file", "a file to write", "Choose another name."};
  }
  return Error{{path_.string()},
               fmt::format("that it cannot {} the file ({})", action, fault.message()),
               "a file name in a folder with space and permission to write",
               "Check the folder, the disk and the permissions."};
}

}  // namespace zerorate::recording
