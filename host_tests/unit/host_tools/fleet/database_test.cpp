// The database between a writer and readers, and recordings not all axes of which measured.

#include "host_tools/lib/fleet/database.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tests/unit/host_tools/fleet/made_fleet.hpp"
#include "host_tools/lib/fleet/population.hpp"

namespace zerorate::fleet {
namespace {

using ::testing::HasSubstr;

StoredRecording recording_called(const std::string& name) {
  return {.hash = name, .entry = {.name = name + ".csv", .sensor = name}};
}

std::size_t count_rows(const Database& database) {
  std::size_t rows = 0;
  database.for_each([&](const StoredRecording&) { ++rows; });
  return rows;
}

class FleetDatabase : public ::testing::Test {
 protected:
  testing::ScratchFolder folder_;
  std::filesystem::path path_ = folder_.path() / "fleet.sqlite";
};

TEST_F(FleetDatabase, IsReadBetweenTheTransactionsOfAWriter) {
  Database writer{path_, Database::Access::write};
  writer.store(recording_called("a"));
  {
    const Database reader{path_, Database::Access::read};
    EXPECT_EQ(count_rows(reader), 1);
    EXPECT_EQ(count_rows(reader), 1);
  }
  writer.store(recording_called("b"));
  EXPECT_EQ(count_rows(Database{path_, Database::Access::read}), 2);
}

TEST_F(FleetDatabase, HasOneWriterUntilItCloses) {
  {
    const Database writer{path_, Database::Access::write};
    EXPECT_THAT(
        [&] {
          (Database{path_, Database::Access::write});
        },
        ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("another process")));
  }
  EXPECT_NO_THROW((Database{path_, Database::Access::write}));
}

/// A minute at 50 Hz whose axis z is at full scale.
std::string recording_with_a_dead_axis() {
  std::mt19937_64 generator{5};
  std::normal_distribution<double> rate_dps{0.3, 0.05};
  std::string text = "t_s,gx_dps,gy_dps,gz_dps\n";
  for (int k = 0; k < 3'000; ++k) {
    text += fmt::format("{:.2f},{:.6f},{:.6f},2000\n", 0.02 * k, rate_dps(generator),
                        rate_dps(generator));
  }
  return text;
}

TEST_F(FleetDatabase, KeepsTheAxesBesideADeadOne) {
  const std::filesystem::path file = folder_.write("dead.csv", recording_with_a_dead_axis());
  Database database{path_, Database::Access::write};
  const RunSummary summary =
      run({{.path = file, .name = "dead.csv", .sensor = "S1"}}, database, RunOptions{});
  ASSERT_EQ(summary.bad.size(), 1);
  EXPECT_THAT(summary.bad[0].problem, HasSubstr("axis z no longer measures"));
  std::vector<std::string> axes;
  database.for_each([&](const StoredRecording& one) {
    for (const AxisResult& axis : one.result.axes) axes.push_back(axis.axis);
  });
  EXPECT_THAT(axes, ::testing::ElementsAre("x", "y"));
}

TEST_F(FleetDatabase, SensorWithADeadAxisIsNotAccepted) {
  const std::filesystem::path file = folder_.write("dead.csv", recording_with_a_dead_axis());
  const Acceptance all = accept(recording::Input{file}, Limits{}, "all");
  EXPECT_EQ(all.judgement, Judgement::fail);
  EXPECT_THAT(all.reasons, ::testing::Contains(HasSubstr("axis z no longer measures")));
  EXPECT_EQ(accept(recording::Input{file}, Limits{}, "x").judgement, Judgement::pass);
}

}  // namespace
}  // namespace zerorate::fleet
