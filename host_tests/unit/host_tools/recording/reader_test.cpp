#include "host_tools/lib/recording/reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "host_tests/support/folders.hpp"

namespace zerorate::recording {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr float kDegree = 0.017453292519943295F;

class Files : public ::testing::Test {
 protected:
  std::vector<Row> read(std::string_view text) {
    Reader reader{folder_.write("run.csv", text)};
    std::vector<Row> rows;
    for (Row row; reader.next(row);) {
      rows.push_back(row);
    }
    return rows;
  }

  std::filesystem::path pack(const std::string& name, const std::vector<std::string>& members) {
    const std::filesystem::path path = folder_.path() / name;
    for (const std::string& member : members) {
      gzFile file = gzopen(path.c_str(), "ab");
      EXPECT_EQ(gzwrite(file, member.data(), static_cast<unsigned>(member.size())),
                static_cast<int>(member.size()));
      EXPECT_EQ(gzclose(file), Z_OK);
    }
    return path;
  }

  zerorate::testing::ScratchFolder folder_;
};

class RecordingInDegrees : public Files {};

TEST_F(RecordingInDegrees, IsGivenInRadPerSecondAndNanoseconds) {
  const auto rows = read("t_s,gx_dps,gy_dps,gz_dps\n0.00,1,-2,0\n0.01,90,0.5,-0.25\n");
  ASSERT_EQ(rows.size(), 2);
  EXPECT_EQ(rows[0].time_ns, 0);
  EXPECT_THAT(rows[0].rate_rad_s, ElementsAre(kDegree, -2.0F * kDegree, 0.0F));
  EXPECT_EQ(rows[1].time_ns, 10'000'000);
  EXPECT_FLOAT_EQ(rows[1].rate_rad_s[0], 1.5707964F);
  EXPECT_TRUE(rows[1].findings.empty());
}

class RecordingWithAllColumns : public Files {};

TEST_F(RecordingWithAllColumns, IsReadByNameInAnyOrder) {
  const auto path =
      folder_.write("run.csv",
                    "still,ax_g,odometer_pulses,rate_radps,temperature_c,note,time_s\n"
                    "1,9.8,12,0.125,25.5,\"stop, engine on\",1e-3\n0,9.8,13.0,-0.5,25.25,,2e-3\n");
  Reader reader{path};
  EXPECT_EQ(reader.columns(), (Columns{1, RateUnit::rad_per_s, true, true, true}));
  EXPECT_THAT(reader.ignored_columns(), ElementsAre("ax_g", "note"));
  Row row;
  ASSERT_TRUE(reader.next(row));
  EXPECT_EQ(row.time_ns, 1'000'000);
  EXPECT_EQ(row.rate_rad_s[0], 0.125F);
  EXPECT_EQ(row.temperature_degc, 25.5F);
  EXPECT_EQ(row.odometer_pulses, 12);
  EXPECT_TRUE(row.still);
  EXPECT_EQ(reader.line(), 2);
  ASSERT_TRUE(reader.next(row));
  EXPECT_EQ(row.odometer_pulses, 13);
  EXPECT_FALSE(row.still);
  EXPECT_FALSE(reader.next(row));
  EXPECT_EQ(row.odometer_pulses, 13) << "the row stays as it was at the end of the file";
}

class RecordingWithAccelerations : public Files {};

TEST_F(RecordingWithAccelerations, IsReadInEitherUnit) {
  for (const auto& [unit, per_unit] : {std::pair{"mps2", 1.0F}, std::pair{"g", 9.80665F}}) {
    const std::string name = unit;
    Reader reader{folder_.write("run.csv", "t_s,az_" + name + ",ax_" + name + ",rate_dps,ay_" +
                                               name + "\n0,1.5,-0.25,3,0.125\n1,,0,3,nan\n")};
    EXPECT_TRUE(reader.columns().acceleration);
    Row row;
    ASSERT_TRUE(reader.next(row));
    EXPECT_THAT(row.acceleration_m_s2,
                ElementsAre(-0.25F * per_unit, 0.125F * per_unit, 1.5F * per_unit));
    ASSERT_TRUE(reader.next(row));
    EXPECT_TRUE(row.findings.has(Finding::acceleration_lost));
    EXPECT_FALSE(row.findings.has(Finding::rate_lost));
    EXPECT_EQ(reader.findings().count(Finding::acceleration_lost), 1);
  }
}

TEST_F(RecordingWithAccelerations, OfTwoAxesOnlyLeavesThemOut) {
  Reader reader{folder_.write("run.csv", "t_s,ax_g,ay_g,rate_dps\n0,1,2,3\n")};
  EXPECT_FALSE(reader.columns().acceleration);
  EXPECT_THAT(reader.ignored_columns(), ElementsAre("ax_g", "ay_g"));
}

class RecordingWithReference : public Files {};

TEST_F(RecordingWithReference, GivesRadiansAndFlagsMissing) {
  Reader reader{folder_.write("run.csv",
                              "t_s,rate_dps,ref_heading_deg,ref_rate_dps,ref_speed_mps\n"
                              "0,1,360,-90,13.5\n1,1,,nan,inf\n2,1,1,1,1\n3,1,1,1,\n")};
  EXPECT_THAT(reader.ignored_columns(), IsEmpty());
  EXPECT_TRUE(reader.columns().ref_heading && reader.columns().ref_rate);
  EXPECT_TRUE(reader.columns().ref_speed);
  Row row;
  ASSERT_TRUE(reader.next(row));
  EXPECT_FLOAT_EQ(row.ref_heading_rad, 6.2831853F);
  EXPECT_FLOAT_EQ(row.ref_rate_rad_s, -1.5707964F);
  EXPECT_EQ(row.ref_speed_m_s, 13.5F);
  EXPECT_TRUE(row.findings.empty());
  ASSERT_TRUE(reader.next(row));
  EXPECT_TRUE(std::isnan(row.ref_heading_rad) && std::isnan(row.ref_rate_rad_s));
  EXPECT_TRUE(row.findings.has(Finding::reference_missing));
  ASSERT_TRUE(reader.next(row) && reader.next(row));
  EXPECT_EQ(reader.findings().count(Finding::reference_missing), 2);
  EXPECT_EQ(reader.findings().first_line(Finding::reference_missing), 3);
}

TEST_F(RecordingWithReference, MayHoldAnySubsetOfIt) {
  Reader reader{folder_.write("run.csv", "t_s,rate_dps,ref_speed_mps\n0,1,2\n")};
  EXPECT_FALSE(reader.columns().ref_heading || reader.columns().ref_rate);
  EXPECT_TRUE(reader.columns().ref_speed);
  Row row;
  ASSERT_TRUE(reader.next(row));
  EXPECT_TRUE(std::isnan(row.ref_heading_rad));
  EXPECT_TRUE(row.findings.empty()) << "a column that is absent is not missing";
}

TEST_F(RecordingWithReference, RefusesTextAndTwoOfAColumn) {
  EXPECT_THROW(read("t_s,rate_dps,ref_heading_deg\n0,1,north\n"), Error);
  EXPECT_THROW(read("t_s,rate_dps,ref_speed_mps,ref_speed_mps\n0,1,1,1\n"), Error);
}

class TextVariants : public Files {};

TEST_F(TextVariants, OfLineEndsQuotesAndBlanksAreAccepted) {
  const auto rows = read(
      "\xEF\xBB\xBF# made by a logger\r\n#\r\n\r\n\"t_s\" , \"rate_dps\"\r\n 0 ,\t1 "
      "\r\n+1,+2\r\n\r\n\r\n");
  ASSERT_EQ(rows.size(), 2);
  EXPECT_EQ(rows[1].time_ns, 1'000'000'000);
  EXPECT_FLOAT_EQ(rows[1].rate_rad_s[0], 2.0F * kDegree);
}

TEST_F(TextVariants, WithoutTheLastLineEndAreReadAndFlagged) {
  const auto rows = read("t_s,rate_dps\n0,1\n1,2");
  ASSERT_EQ(rows.size(), 2);
  EXPECT_TRUE(rows[0].findings.empty());
  EXPECT_TRUE(rows[1].findings.has(Finding::line_unterminated));
}

class GzipRecording : public Files {};

TEST_F(GzipRecording, IsKnownByItsContentAndMayHaveSeveralMembers) {
  Reader reader{pack("run.csv", {"t_s,rate_dps\n0,1\n1,", "2\n2,3\n"})};
  std::vector<std::int64_t> times;
  for (Row row; reader.next(row);) {
    times.push_back(row.time_ns / 1'000'000'000);
  }
  EXPECT_THAT(times, ElementsAre(0, 1, 2));
}

TEST_F(GzipRecording, LongerThanAllBuffersIsReadWhole) {
  std::string text = "t_s,rate_radps\n";
  constexpr std::int64_t kRows = 300'000;
  const auto rate = [](std::int64_t row) { return (row * 7'919) % 100'003; };
  for (std::int64_t i = 0; i < kRows; ++i) {
    text += std::to_string(i) + "e-2," + std::to_string(rate(i)) + "\n";
  }
  Reader reader{pack("long.csv.gz", {text})};
  double progress = 0.0;
  std::int64_t rows = 0;
  for (Row row; reader.next(row); ++rows) {
    ASSERT_EQ(row.time_ns, rows * 10'000'000);
    ASSERT_EQ(row.rate_rad_s[0], static_cast<float>(rate(rows)));
    ASSERT_GE(reader.fraction_read().value(), progress);
    progress = reader.fraction_read().value();
  }
  EXPECT_EQ(rows, kRows);
  EXPECT_EQ(reader.fraction_read(), 1.0);
}

class RecordingWithoutExtras : public Files {};

TEST_F(RecordingWithoutExtras, HasNoIgnoredColumns) {
  EXPECT_THAT(Reader{folder_.write("run.csv", "t_s,rate_dps\n0,1\n")}.ignored_columns(), IsEmpty());
}

class StandardInput : public Files {};

TEST_F(StandardInput, IsReadAsMinusWithoutAShareOfTheWhole) {
  const auto path = pack("run.csv.gz", {"t_s,rate_dps\n0,1\n1,x\n"});
  ASSERT_NE(std::freopen(path.c_str(), "rb", stdin), nullptr);
  Reader reader{"-"};
  Row row;
  EXPECT_TRUE(reader.next(row));
  EXPECT_EQ(reader.fraction_read(), std::nullopt);
  try {
    EXPECT_FALSE(reader.next(row));
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::StartsWith("standard input:3:3: found \"x\""));
  }
}

}  // namespace
}  // namespace zerorate::recording
