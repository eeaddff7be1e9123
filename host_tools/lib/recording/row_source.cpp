#include "host_tools/lib/recording/row_source.hpp"

#include <array>
#include <system_error>
#include <utility>

#include "host_tools/lib/recording/csv_rows.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/motion.hpp"

namespace zerorate::recording {
namespace {

/// The file of the gyro in a folder as EuRoC lays it out; other paths as they are.
std::filesystem::path text_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored)) return path;
  for (const char* const place : {"mav0/imu0/data.csv", "imu0/data.csv", "data.csv"}) {
    if (std::filesystem::exists(path / place, ignored)) return path / place;
  }
  return path;
}

}  // namespace

std::unique_ptr<RowSource> open_rows(const Input& input) {
  return with_motion(std::make_unique<CsvRows>(text_file(input.path), input.layout, Needs::rates),
                     input);
}

std::unique_ptr<RowSource> with_motion(std::unique_ptr<RowSource> rates, const Input& input) {
  const Columns& columns = rates->columns();
  const SpeedRule rule = input.speed.value_or(SpeedRule{});
  if (!input.odometer_path.empty()) {
    return std::make_unique<WithMotion>(
        std::move(rates),
        std::make_unique<CsvRows>(input.odometer_path, input.odometer_layout, Needs::motion), rule);
  }
  if (columns.speed && !columns.odometer && !columns.still) {
    return std::make_unique<WithMotion>(std::move(rates), nullptr, rule);
  }
  if (!input.speed) return rates;
  throw Error{{input.path.string()},
              columns.speed ? "pulses or still beside the speed" : "no speed",
              "a speed alone for --still-below, --speed-delay and --metres-per-pulse",
              "Name its column: --speed-column NAME --units speed=mps."};
}

}  // namespace zerorate::recording
