/// @file
/// Rows of a gyro, marked as still or moving by the speed or the odometer of the vehicle.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_tools/lib/recording/findings.hpp"
#include "host_tools/lib/recording/row_source.hpp"

namespace zerorate::recording {

/// Joins rates with the word of an odometer that has a rate, a delay and a file of its own.
///
/// A row is still if the newest speed before it and the next one after it are both zero. Silence is
/// no standstill: without a word for a second and three of its median intervals the row is flagged
/// `motion_unknown`, and the vehicle moves. Memory: the rows of one such silence.
class WithMotion : public RowSource {
 public:
  /// @param rates   the gyro, whose own odometer columns are replaced
  /// @param motion  pulses, still or speed on the same clock; nullptr: the speed stands beside the
  /// rates
  WithMotion(std::unique_ptr<RowSource> rates, std::unique_ptr<RowSource> motion,
             const SpeedRule& rule);

  [[nodiscard]] const Columns& columns() const override { return columns_; }
  [[nodiscard]] bool next(Row& row) override;
  [[nodiscard]] std::uint64_t line() const override { return line_; }
  [[nodiscard]] std::optional<double> fraction_read() const override {
    return rates_->fraction_read();
  }
  [[nodiscard]] std::vector<std::string> ignored_columns() const override {
    return rates_->ignored_columns();
  }
  [[nodiscard]] LeftOut left_out() const override { return rates_->left_out(); }

 private:
  /// A statement of the odometer on one moment.
  struct Word {
    std::int64_t at_ns = 0;
    bool moves = false;
    std::int64_t pulses = 0;  ///< since the word before
  };

  [[nodiscard]] bool read_rates();
  void hear_until(std::int64_t time_ns);
  [[nodiscard]] std::optional<Word> hear(std::int64_t latest_ns);
  [[nodiscard]] std::optional<Word> hear_beside(std::int64_t latest_ns);
  [[nodiscard]] std::optional<Word> word_of(const Row& row);
  [[nodiscard]] double fastest_wheel_m_s(const Row& row) const;
  [[nodiscard]] Word word_of_speed(const Row& row, std::int64_t at_ns);
  [[nodiscard]] bool is_known_at(std::int64_t time_ns) const;
  [[nodiscard]] std::int64_t patience_ns() const;

  std::unique_ptr<RowSource> rates_;
  std::unique_ptr<RowSource> motion_;
  SpeedRule rule_;
  Columns columns_;
  Columns motion_columns_;
  std::deque<NumberedRow> ahead_;
  std::deque<Word> heard_;      ///< beside the rows of ahead_, where rates and speed share a file
  std::optional<Word> before_;  ///< newest word that is not after the row
  std::optional<Word> after_;   ///< the word that follows it
  std::optional<Row> last_motion_;
  std::optional<std::int64_t> latest_word_ns_;
  IntervalMedian interval_;
  double rest_of_pulse_ = 0.0;
  std::int64_t pulses_ = 0;
  std::uint64_t line_ = 0;
};

}  // namespace zerorate::recording
