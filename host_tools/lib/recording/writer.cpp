#include "host_tools/lib/recording/writer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <iterator>
#include <system_error>
#include <utility>

#include "host_tools/lib/recording/header.hpp"
#include "host_tools/lib/recording/number.hpp"

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

}  // namespace

void append_row(std::string& text, const Columns& columns, const Row& row) {
  append_seconds(text, row.time_ns);
  for (std::size_t axis = 0; axis < columns.axis_count; ++axis) {
    append_measured(text, row.rate_rad_s[axis], rad_per_s_in(columns.rate_unit));
  }
  if (columns.temperature) append_measured(text, row.temperature_degc, 1.0);
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

}  // namespace zerorate::recording
