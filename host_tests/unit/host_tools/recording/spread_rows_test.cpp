#include "host_tools/lib/recording/spread_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace zerorate::recording {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

/// Rows with given stamps, whose rates count them.
class RowsWithStamps : public RowSource {
 public:
  explicit RowsWithStamps(std::vector<std::int64_t> stamps_ns) : stamps_ns_(std::move(stamps_ns)) {}

  [[nodiscard]] const Columns& columns() const override { return columns_; }
  [[nodiscard]] bool next(Row& row) override {
    if (given_ == stamps_ns_.size()) return false;
    row = {};
    row.time_ns = stamps_ns_[given_++];
    row.rate_rad_s[0] = static_cast<float>(given_);
    return true;
  }
  [[nodiscard]] std::uint64_t line() const override { return given_; }
  [[nodiscard]] std::optional<double> fraction_read() const override { return std::nullopt; }

 private:
  Columns columns_;
  std::vector<std::int64_t> stamps_ns_;
  std::size_t given_ = 0;
};

SpreadRows spread(std::vector<std::int64_t> stamps_ns) {
  return {std::make_unique<RowsWithStamps>(std::move(stamps_ns)), "run"};
}

/// Stamps of at most a hundred rows: rows without an end fail the test.
std::vector<std::int64_t> all_of(SpreadRows& rows) {
  std::vector<std::int64_t> times_ns;
  for (Row row; times_ns.size() < 100 && rows.next(row);) times_ns.push_back(row.time_ns);
  return times_ns;
}

TEST(EndOfSpreadRows, ComesOnceAndForAllBehindTheLastRow) {
  for (const std::vector<std::int64_t>& stamps_ns :
       {std::vector<std::int64_t>{}, {5}, {5, 5}, {5, 15, 25}, {0, 0, 20, 20, 40, 40}}) {
    SpreadRows rows = spread(stamps_ns);
    EXPECT_EQ(all_of(rows).size(), stamps_ns.size());
    const std::uint64_t last_line = rows.line();
    Row row;
    row.time_ns = 77;
    for (int times = 0; times < 5; ++times) EXPECT_FALSE(rows.next(row));
    EXPECT_EQ(row.time_ns, 77) << "the row stays as it was";
    EXPECT_EQ(rows.line(), last_line);
  }
}

TEST(LastStampOfSpreadRows, HasTheMeanIntervalOfThoseBefore) {
  SpreadRows rows = spread({0, 0, 20, 20, 40, 40});
  EXPECT_THAT(all_of(rows), ElementsAre(0, 10, 20, 30, 40, 50));
}

TEST(RowsWithStampsOfTheirOwn, AreGivenAsTheyAre) {
  const std::vector<std::int64_t> stamps_ns{3, 8, 13, 19, 200};
  SpreadRows rows = spread(stamps_ns);
  EXPECT_THAT(all_of(rows), ElementsAreArray(stamps_ns));
}

}  // namespace
}  // namespace zerorate::recording
