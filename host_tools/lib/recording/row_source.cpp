#include "host_tools/lib/recording/row_source.hpp"

#include <cmath>
#include <system_error>
#include <utility>
#include <vector>

#include "host_tools/lib/recording/bag_rows.hpp"
#include "host_tools/lib/recording/csv_rows.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/recording/increments.hpp"
#include "host_tools/lib/recording/kitti_rows.hpp"
#include "host_tools/lib/recording/motion.hpp"
#include "host_tools/lib/recording/ordered_rows.hpp"
#include "host_tools/lib/recording/spread_rows.hpp"

namespace zerorate::recording {
namespace {

/// Rows at equal intervals, whatever their stamps.
class NumberedTimes : public RowSource {
 public:
  NumberedTimes(std::unique_ptr<RowSource> rows, double rate_hz)
      : rows_(std::move(rows)), columns_(rows_->columns()), period_ns_(1e9 / rate_hz) {
    columns_.is_timed_by_rows = true;
  }

  [[nodiscard]] const Columns& columns() const override { return columns_; }
  [[nodiscard]] bool next(Row& row) override {
    if (!rows_->next(row)) return false;
    row.time_ns = std::llround(period_ns_ * static_cast<double>(count_++));
    return true;
  }
  [[nodiscard]] std::uint64_t line() const override { return rows_->line(); }
  [[nodiscard]] std::optional<double> fraction_read() const override {
    return rows_->fraction_read();
  }
  [[nodiscard]] std::vector<std::string> ignored_columns() const override {
    return rows_->ignored_columns();
  }
  [[nodiscard]] LeftOut left_out() const override { return rows_->left_out(); }

 private:
  std::unique_ptr<RowSource> rows_;
  Columns columns_;
  double period_ns_;
  std::uint64_t count_ = 0;
};

/// The file of the gyro in a folder as EuRoC lays it out; other paths as they are.
std::filesystem::path text_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored)) return path;
  for (const char* const place : {"mav0/imu0/data.csv", "imu0/data.csv", "data.csv"}) {
    if (std::filesystem::exists(path / place, ignored)) return path / place;
  }
  return path;
}

/// Joins rates with the odometer that the user named, or with the speed that stands beside them.
std::unique_ptr<RowSource> with_odometer_file(std::unique_ptr<RowSource> rates,
                                              const Input& input) {
  const Columns& columns = rates->columns();
  const SpeedRule rule = input.speed.value_or(SpeedRule{});
  if (!input.odometer_path.empty()) {
    return std::make_unique<WithMotion>(
        std::move(rates),
        on_one_time_line(
            std::make_unique<CsvRows>(input.odometer_path, input.odometer_layout, Needs::motion),
            input.odometer_path.string()),
        rule);
  }
  if (columns.speed && !columns.odometer && !columns.still) {
    return std::make_unique<WithMotion>(std::move(rates), nullptr, rule);
  }
  if (!input.speed) return rates;
  throw Error{
      {input.path.string()},
      columns.speed ? "pulses or still beside the speed" : "no speed",
      "a speed alone for --still-below, --speed-delay, --track-width and --metres-per-pulse",
      "Name its column: --speed-column NAME --units speed=mps."};
}

#ifdef ZERORATE_HAS_SQLITE

std::unique_ptr<RowSource> open_rows_of_bag(const Input& input) {
  std::unique_ptr<Bag> bag = open_bag(input.path);
  if (!bag) return nullptr;
  if (!input.layout.columns.empty() || !input.layout.units.empty()) {
    throw Error{{input.path.string()},
                std::string(bag->format().name),
                "no columns and units: its messages define them",
                "Leave out --columns and --units; --topic names what is read."};
  }
  const bool has_odometry =
      !input.odometry_topic.empty() || !bag->topics(MessageType::odometry).empty();
  auto rates = on_one_time_line(
      std::make_unique<BagRows>(std::move(bag), Needs::rates, input.topic), input.path.string());
  if (!has_odometry || !input.odometer_path.empty())
    return with_odometer_file(std::move(rates), input);
  // Opened once more, because a chunk is unpacked again when two read at places of their own.
  auto motion = on_one_time_line(
      std::make_unique<BagRows>(open_bag(input.path), Needs::motion, input.odometry_topic),
      input.path.string());
  return std::make_unique<WithMotion>(std::move(rates), std::move(motion),
                                      input.speed.value_or(SpeedRule{}));
}

#else

/// This build reads no bags.
std::unique_ptr<RowSource> open_rows_of_bag(const Input& /*input*/) {
  return nullptr;
}

#endif

}  // namespace

std::unique_ptr<RowSource> on_one_time_line(std::unique_ptr<RowSource> rows,
                                            const std::string& name,
                                            std::optional<double> rows_at_hz) {
  const bool are_increments = rows->columns().are_increments;
  if (rows_at_hz) {
    rows = std::make_unique<NumberedTimes>(std::move(rows), *rows_at_hz);
  } else {
    rows = std::make_unique<OrderedRows>(std::move(rows), name);
    rows = std::make_unique<SpreadRows>(std::move(rows), name);
  }
  if (are_increments) rows = std::make_unique<RatesOfIncrements>(std::move(rows));
  return rows;
}

std::unique_ptr<RowSource> open_rows(const Input& input) {
  if (auto bag = open_rows_of_bag(input)) return bag;
  if (const auto folder = kitti_folder(input.path)) {
    return with_odometer_file(
        on_one_time_line(std::make_unique<KittiRows>(*folder), input.path.string()), input);
  }
  return with_odometer_file(
      on_one_time_line(std::make_unique<CsvRows>(text_file(input.path), input.layout, Needs::rates),
                       input.path.string(), input.layout.rows_at_hz),
      input);
}

}  // namespace zerorate::recording
