#include "host_tools/lib/recording/kitti_rows.hpp"

#include <fmt/format.h>

#include <string_view>
#include <system_error>

#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/fields.hpp"
#include "host_tools/lib/recording/number.hpp"

namespace zerorate::recording {
namespace {

constexpr std::size_t kSpeed = 8;          // vf
constexpr std::size_t kAcceleration = 11;  // ax, ay, az
constexpr std::size_t kRate = 17;          // wx, wy, wz

}  // namespace

std::optional<std::filesystem::path> kitti_folder(const std::filesystem::path& path) {
  std::error_code ignored;
  // The folder of the samples is beside their stamps.
  const auto above = path.filename() == "data" ? path.parent_path() : path;
  for (const auto& folder : {path, path / "oxts", above}) {
    if (std::filesystem::exists(folder / "timestamps.txt", ignored) &&
        std::filesystem::is_directory(folder / "data", ignored)) {
      return folder;
    }
  }
  return std::nullopt;
}

KittiRows::KittiRows(const std::filesystem::path& folder)
    : folder_(folder), stamps_(folder / "timestamps.txt") {
  columns_.rate_unit = RateUnit::rad_per_s;
  columns_.acceleration = true;
  columns_.speed = true;
  columns_.program = "KITTI";
}

bool KittiRows::next(Row& row) {
  std::string_view stamp;
  if (!stamps_.next(stamp) || stamp.empty()) return false;
  const auto time_ns = parse_calendar_time(stamp);
  if (!time_ns) {
    throw Error{stamps_.place(), excerpt(stamp) + " as a stamp",
                "a time such as 2011-09-26 13:02:25.964389445", "Repair or remove the sample."};
  }
  const std::array<double, kNumbers> numbers = read_sample();
  row = {.time_ns = *time_ns, .speed_m_s = to_si(numbers[kSpeed], 1.0)};
  for (std::size_t i = 0; i < kMaxAxes; ++i) {
    row.rate_rad_s[i] = to_si(numbers[kRate + i], 1.0);
    row.acceleration_m_s2[i] = to_si(numbers[kAcceleration + i], 1.0);
  }
  return true;
}

std::array<double, KittiRows::kNumbers> KittiRows::read_sample() const {
  LineReader lines{folder_ / "data" / fmt::format("{:010}.txt", stamps_.line() - 1)};
  std::string_view line;
  std::array<double, kNumbers> numbers{};
  std::size_t count = 0;
  if (lines.next(line)) {
    for (Fields fields{line, ' '}; fields.next() && count < kNumbers; ++count) {
      const auto number = parse_real(fields.text());
      if (!number) {
        throw Error{lines.place(fields.column()), excerpt(fields.text()), "a number",
                    "Repair the file, or remove it and its stamp."};
      }
      numbers[count] = *number;
    }
  }
  if (count == kNumbers) return numbers;
  throw Error{lines.place(), fmt::format("{} numbers", count), "30 numbers, separated by spaces",
              "Copy the file again."};
}

}  // namespace zerorate::recording
