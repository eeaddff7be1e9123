#include "host_tools/lib/recording/writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::recording {
namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in{path, std::ios::binary};
  return {std::istreambuf_iterator<char>{in}, {}};
}

std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator{folder}, {}));
}

class WrittenRecording : public ::testing::TestWithParam<std::tuple<const char*, Columns>> {
 protected:
  zerorate::testing::ScratchFolder folder_;
};

TEST_P(WrittenRecording, ComesBackBitForBit) {
  const auto& [name, columns] = GetParam();
  std::mt19937_64 random{7};
  std::normal_distribution<float> normal;
  std::vector<std::int64_t> times_ns(20'000);
  for (std::int64_t& time_ns : times_ns) time_ns = static_cast<std::int64_t>(random() >> 2U);
  std::ranges::sort(times_ns);
  std::vector<Row> written;
  for (int i = 0; i < 20'000; ++i) {
    const float scale = std::exp(10.0F * normal(random));
    Row row{.time_ns = times_ns[static_cast<std::size_t>(i)],
            .odometer_pulses = i,
            .still = random() % 2 == 0,
            .ref_heading_rad = 7.0F * normal(random),
            .ref_rate_rad_s = scale * normal(random),
            .ref_speed_m_s = 30.0F * normal(random)};
    for (float& rate : row.rate_rad_s) {
      rate = scale * normal(random);
    }
    row.temperature_degc = 25.0F + 30.0F * normal(random);
    for (float& along : row.acceleration_m_s2) along = scale * normal(random);
    written.push_back(row);
  }
  written[1].rate_rad_s[0] = std::nanf("");
  written[2].rate_rad_s[0] = INFINITY;
  Writer writer{folder_.path() / name, columns};
  for (const Row& row : written) {
    writer.write(row);
  }
  writer.finish();

  Reader reader{folder_.path() / name};
  EXPECT_EQ(reader.columns(), columns);
  for (const Row& expected : written) {
    Row row;
    ASSERT_TRUE(reader.next(row));
    EXPECT_EQ(row.time_ns, expected.time_ns);
    for (std::size_t axis = 0; axis < columns.axis_count; ++axis) {
      if (std::isnan(expected.rate_rad_s[axis])) {
        EXPECT_TRUE(std::isnan(row.rate_rad_s[axis]));
      } else {
        ASSERT_EQ(row.rate_rad_s[axis], expected.rate_rad_s[axis]) << "line " << reader.line();
      }
    }
    if (columns.acceleration) {
      ASSERT_EQ(row.acceleration_m_s2, expected.acceleration_m_s2);
    }
    if (columns.temperature) {
      EXPECT_EQ(row.temperature_degc, expected.temperature_degc);
    }
    EXPECT_EQ(row.odometer_pulses, columns.odometer ? expected.odometer_pulses : 0);
    EXPECT_EQ(row.still, columns.still && expected.still);
    if (columns.ref_heading) {
      ASSERT_EQ(row.ref_heading_rad, expected.ref_heading_rad);
    }
    if (columns.ref_rate) {
      ASSERT_EQ(row.ref_rate_rad_s, expected.ref_rate_rad_s);
    }
    if (columns.ref_speed) {
      ASSERT_EQ(row.ref_speed_m_s, expected.ref_speed_m_s);
    }
  }
  Row row;
  EXPECT_FALSE(reader.next(row));
}

INSTANTIATE_TEST_SUITE_P(
    Of, WrittenRecording,
    ::testing::Combine(
        ::testing::Values("run.csv", "run.csv.gz"),
        ::testing::Values(Columns{3, RateUnit::deg_per_s, true, true, true},
                          Columns{3, RateUnit::deg_per_s, false, true, false, true, true, true},
                          Columns{3, RateUnit::rad_per_s, false, true, false, false, false, true},
                          Columns{3, RateUnit::rad_per_s, false, true, false},
                          Columns{1, RateUnit::deg_per_s, true, false, false},
                          Columns{.temperature = true, .odometer = true, .acceleration = true},
                          Columns{1, RateUnit::rad_per_s, false, false, true})));

TEST(RewrittenText, IsTheSameText) {
  const zerorate::testing::ScratchFolder folder;
  const std::string text =
      "t_s,gx_dps,gy_dps,gz_dps,temp_c\n0,-0.05,-0.3,0.7,25.5182\n0.01,0.35,1e-07,123.456,-18\n";
  Reader reader{folder.write("in.csv", text)};
  Writer writer{folder.path() / "out.csv", reader.columns()};
  for (Row row; reader.next(row);) {
    writer.write(row);
  }
  writer.finish();
  EXPECT_EQ(bytes_of(folder.path() / "out.csv"), text);
}

TEST(SameRowsWrittenTwice, GiveTheSameGzipBytes) {
  const zerorate::testing::ScratchFolder folder;
  for (const char* name : {"a.csv.gz", "b.csv.gz"}) {
    Writer writer{folder.path() / name, {}};
    writer.write({});
    writer.finish();
  }
  EXPECT_EQ(bytes_of(folder.path() / "a.csv.gz"), bytes_of(folder.path() / "b.csv.gz"));
  EXPECT_EQ(bytes_of(folder.path() / "a.csv.gz").substr(0, 2), "\x1F\x8B");
}

TEST(WriterThatIsNotFinished, LeavesTheFolderAsItWas) {
  const zerorate::testing::ScratchFolder folder;
  const auto path = folder.write("run.csv", "older");
  {
    Writer writer{path, {}};
    writer.write({});
    EXPECT_EQ(files_in(folder.path()), 2);
  }
  EXPECT_EQ(files_in(folder.path()), 1);
  EXPECT_EQ(bytes_of(path), "older");
}

TEST(WriterThroughASymbolicLink, ReplacesTheFileAndKeepsTheLink) {
  const zerorate::testing::ScratchFolder folder;
  const auto file = folder.write("run.csv", "older");
  std::filesystem::create_symlink(file, folder.path() / "link.csv");
  Writer writer{folder.path() / "link.csv", {1, RateUnit::deg_per_s, false, false, false}};
  writer.write({});
  writer.finish();
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link.csv"));
  EXPECT_EQ(bytes_of(file), "t_s,rate_dps\n0,0\n");
}

TEST(WriterToAFolderThatIsNotThere, SaysSo) {
  try {
    Writer writer{"/nonexistent/run.csv", {}};
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("No such file or directory"));
    EXPECT_EQ(error.place().file, "/nonexistent/run.csv");
  }
}

TEST(WriterToAFifoOrDirectory, IsRefused) {
  const zerorate::testing::ScratchFolder folder;
  const auto fifo = folder.path() / "fifo";
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_THROW((Writer{fifo, {}}), Error);
  EXPECT_THROW((Writer{folder.path(), {}}), Error);
}

void write_rows(const std::filesystem::path& path, int count) {
  Writer writer{path, {}};
  for (int i = 0; i < count; ++i) {
    writer.write({});
  }
  writer.finish();
}

TEST(WriterToAFullDisk, ThrowsAndLeavesNothing) {
  const zerorate::testing::ScratchFolder folder;
  const zerorate::testing::FileSizeLimit limit{4'096};
  for (const int rows : {1'000, 100'000}) {  // noticed by finish(), and by write()
    EXPECT_THROW(write_rows(folder.path() / "run.csv", rows), Error) << rows;
    EXPECT_EQ(files_in(folder.path()), 0) << rows;
  }
}

}  // namespace
}  // namespace zerorate::recording
