#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <zlib.h>
#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <ostream>
#include <random>
#include <string>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/recording/writer.hpp"

namespace zerorate::recording {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Reads a file to its end and gives the error that stopped it.
Error error_of(const std::filesystem::path& path, std::uint64_t* rows = nullptr) {
  std::uint64_t count = 0;
  try {
    Reader reader{path};
    for (Row row; reader.next(row);) {
      ++count;
    }
  } catch (const Error& error) {
    if (rows != nullptr) {
      *rows = count;
    }
    return error;
  }
  ADD_FAILURE() << path << " was read without an error, rows: " << count;
  return Error{{}, "nothing", "an error", ""};
}

struct BadText {
  const char* name;
  std::string text;
  std::uint64_t line;
  std::uint64_t column;  ///< 0: the line as a whole
  const char* found;
  const char* expected;
};

void PrintTo(const BadText& bad, std::ostream* out) {
  *out << bad.name;
}

class BadTextFile : public ::testing::TestWithParam<BadText> {};

TEST_P(BadTextFile, IsReportedWithItsPlaceAndWhatWasExpected) {
  const zerorate::testing::ScratchFolder folder;
  const auto path = folder.write("run.csv", GetParam().text);
  const Error error = error_of(path);
  EXPECT_EQ(error.place().file, path.string());
  EXPECT_EQ(error.place().line, GetParam().line);
  EXPECT_EQ(error.place().column, GetParam().column);
  EXPECT_THAT(error.found(), HasSubstr(GetParam().found));
  EXPECT_THAT(error.expected(), HasSubstr(GetParam().expected));
  EXPECT_FALSE(error.mend().empty());
  EXPECT_THAT(error.what(), StartsWith(path.string() + ":"));
}

const std::string kHeader = "t_s,gx_dps,gy_dps,gz_dps\n";

INSTANTIATE_TEST_SUITE_P(
    File, BadTextFile,
    ::testing::Values(
        BadText{"empty", "", 0, 0, "an empty file", "a header line"},
        BadText{"only_comments", "# a\n\n# b\n", 3, 0, "only comments", "a header line"},
        BadText{"header_only", kHeader, 1, 0, "no samples", "at least one sample"},
        BadText{"no_header", "0,1,2,3\n", 1, 0, "numbers in the first line", "a header line"},
        BadText{"binary", std::string("\x7F\x45LF\0\1\2,\n", 10), 1, 5, "binary data", "a CSV"},
        BadText{"utf16_without_mark", std::string("t\0_\0s\0\n\0", 8), 1, 2, "binary data",
                "UTF-8"},
        BadText{"semicolon_in_a_row", "t_s,rate_dps\n0;1\n", 2, 1, "0;1", "a time"},
        BadText{"endless_line", std::string(2'000'000, 'x'), 1, 0, "longer than 1 MiB", "a CSV"}),
    [](const auto& tested) { return tested.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Header, BadTextFile,
    ::testing::Values(
        BadText{"no_time", "gx_dps,gy_dps,gz_dps\n", 1, 0, "gx_dps", "t_s or time_s"},
        BadText{"time_in_ms", "t_ms,rate_dps\n", 1, 1, "t_ms", "t_s or time_s (seconds)"},
        BadText{"no_rate", "t_s,vx_mps\n", 1, 0, "t_s,vx_mps", "gx_dps,gy_dps,gz_dps or rate_dps"},
        BadText{"unknown_unit", "t_s,gx_deg/s,gy_deg/s,gz_deg/s\n", 1, 5, "gx_deg/s", "gx_radps"},
        BadText{"other_case", "t_s,Gyro_X\n", 1, 5, "Gyro_X", "gx_dps"},
        BadText{"missing_axis", "t_s,gx_dps,gz_dps\n", 1, 0, "not all three", "rate_dps"},
        BadText{"both_units", "t_s,rate_dps,rate_radps\n", 1, 14, "both rate_dps and rate_radps",
                "in one unit"},
        BadText{"mixed_units", "t_s,gx_dps,gy_radps,gz_dps\n", 1, 12, "both gx_dps and gy_radps",
                "in one unit"},
        BadText{"one_and_three", "t_s,gx_dps,gy_dps,gz_dps,rate_dps\n", 1, 26,
                "both gx_dps and rate_dps", "once"},
        BadText{"axis_twice", "t_s,gx_dps,gx_dps\n", 1, 12, "both gx_dps and gx_dps", "once"},
        BadText{"time_twice", "t_s,time_s,rate_dps\n", 1, 5, "both t_s and time_s", "one of them"},
        BadText{"temperature_twice", "t_s,rate_dps,temp_c,temperature_c\n", 1, 21,
                "both temp_c and temperature_c", "one of them"},
        BadText{"accelerations_in_two_units", "t_s,rate_dps,ax_g,ay_g,az_g,ax_mps2\n", 1, 29,
                "both ax_g and ax_mps2", "the acceleration once and in one unit"}),
    [](const auto& tested) { return tested.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Row, BadTextFile,
    ::testing::Values(
        BadText{"text", kHeader + "0,1,2,3\n0.01,1,abc,3\n", 3, 8, "\"abc\" as gy_dps", "a number"},
        BadText{"number_and_text", kHeader + "0,1,2,3.5x\n", 2, 7, "3.5x", "a number"},
        BadText{"lost_time", kHeader + ",1,2,3\n", 2, 1, "\"\" as t_s", "a time in seconds"},
        BadText{"nan_time", kHeader + "nan,1,2,3\n", 2, 1, "nan", "a time in seconds"},
        BadText{"clock_time", kHeader + "12:30:00,1,2,3\n", 2, 1, "12:30:00", "a time in seconds"},
        BadText{"time_in_ns", kHeader + "1700000000123456789,1,2,3\n", 2, 1, "1700000000123456789",
                "from -2305843009 to 4611686018"},
        BadText{"too_few", kHeader + "0,1,2,3\n1,2\n", 3, 0, "2 fields", "4 as in the header"},
        BadText{"too_many", kHeader + "0,1,2,3,4\n", 2, 0, "5 fields", "4 as in the header"},
        BadText{"decimal_comma", "t_s,rate_dps\n0,01,0,35\n", 2, 0, "4 fields", "2 as in"},
        BadText{"empty_line", kHeader + "0,1,2,3\n\n1,1,2,3\n", 3, 0, "an empty line",
                "one sample"},
        BadText{"broken_count", "t_s,rate_dps,odometer_pulses\n0,1,1.5\n", 2, 5, "1.5",
                "a whole number"},
        BadText{"lost_count", "t_s,rate_dps,odometer_pulses\n0,1,\n", 2, 5, "\"\"",
                "a whole number"},
        BadText{"other_still", "t_s,rate_dps,still\n0,1,2\n", 2, 5, "\"2\" as still", "1 (still)"},
        BadText{"bytes", "t_s,rate_dps\n0,\x01\xFF\n", 2, 3, "\"\\x01\\xFF\"", "a number"}),
    [](const auto& tested) { return tested.param.name; });

TEST(MessageForTextInANumber, NamesPlaceValueAndCure) {
  const Error error{{"run.csv", 17, 6}, "\"abc\" as gx_dps", "a number", "Write nan."};
  EXPECT_STREQ(error.what(),
               "run.csv:17:6: found \"abc\" as gx_dps; expected a number. Write nan.");
}

TEST(FileThatIsNotThere, IsReportedByName) {
  EXPECT_THAT(error_of("/nonexistent/run.csv").what(),
              StartsWith("/nonexistent/run.csv: found No such file or directory"));
}

TEST(DirectoryInsteadOfAFile, IsReportedAsOne) {
  const zerorate::testing::ScratchFolder folder;
  EXPECT_EQ(error_of(folder.path()).found(), "a directory");
}

/// A gzip file of some 100 kB, as bytes.
std::string gzip_bytes() {
  const zerorate::testing::ScratchFolder folder;
  const std::filesystem::path path = folder.path() / "run.csv.gz";
  gzFile file = gzopen(path.c_str(), "wb");
  gzputs(file, "t_s,rate_dps\n");
  for (int i = 0; i < 50'000; ++i) {
    gzprintf(file, "%d,%d\n", i, (i * 7919) % 10'007);
  }
  gzclose(file);
  std::ifstream in{path, std::ios::binary};
  return {std::istreambuf_iterator<char>{in}, {}};
}

TEST(GzipCutAnywhere, GivesTheWholeLinesBeforeTheCutAndThenAnError) {
  const zerorate::testing::ScratchFolder folder;
  const std::string whole = gzip_bytes();
  for (const std::size_t size : {std::size_t{2}, std::size_t{9}, std::size_t{30}, whole.size() / 2,
                                 whole.size() - 8, whole.size() - 1}) {
    std::uint64_t rows = 0;
    const Error error = error_of(folder.write("cut.csv.gz", whole.substr(0, size)), &rows);
    EXPECT_THAT(error.found(), HasSubstr("in the middle of its gzip stream")) << size;
    EXPECT_EQ(error.place().line, rows == 0 ? 1 : rows + 2) << size;
    EXPECT_EQ(rows > 20'000, size >= whole.size() / 2) << size;
  }
}

TEST(GzipWithAWrongByte, IsReportedAsDamaged) {
  const zerorate::testing::ScratchFolder folder;
  std::string checksum_wrong = gzip_bytes();
  checksum_wrong[checksum_wrong.size() - 6] ^= 1;
  EXPECT_THAT(error_of(folder.write("a.gz", checksum_wrong)).found(), HasSubstr("damaged gzip"));
  EXPECT_THAT(error_of(folder.write("b.gz", gzip_bytes() + "rubbish")).found(),
              HasSubstr("damaged gzip"));
}

std::string valid_bytes(const std::string& name) {
  const zerorate::testing::ScratchFolder folder;
  Writer writer{folder.path() / name, {3, RateUnit::deg_per_s, true, true, true}};
  for (int i = 0; i < 40; ++i) {
    const auto x = static_cast<float>(i);
    writer.write({i * std::int64_t{10'000'000}, {0.1F * x, -0.01F, x}, 25.0F, i / 4, i < 20, {}});
  }
  writer.finish();
  std::ifstream in{folder.path() / name, std::ios::binary};
  return {std::istreambuf_iterator<char>{in}, {}};
}

/// Changes, inserts, removes, repeats or cuts at a random place, one to four times.
std::string mutated(std::string bytes, std::mt19937_64& random) {
  constexpr std::string_view kTelling = ",\n\r\"#;-+.eE09nainf \t\0\xFF\x1F\x8B";
  const auto pick = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  for (std::size_t edits = 1 + pick(4); edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = pick(bytes.size());
    const char c = pick(2) == 0 ? kTelling[pick(kTelling.size())] : static_cast<char>(pick(256));
    switch (pick(5)) {
      case 0:
        bytes[at] = c;
        break;
      case 1:
        bytes.insert(at, 1 + pick(20), c);
        break;
      case 2:
        bytes.erase(at, 1 + pick(20));
        break;
      case 3: {
        const std::size_t length = 1 + pick(60);
        bytes.insert(at, bytes.substr(pick(bytes.size()), length));
        break;
      }
      default:
        bytes.resize(at);
    }
  }
  return bytes;
}

/// Reads what it can: true if to the end, false if an error says where it stopped.
bool reads_or_explains(const std::filesystem::path& path) {
  try {
    Reader reader{path};
    std::uint64_t rows = 0;
    for (Row row; reader.next(row);) {
      ++rows;
    }
    EXPECT_GT(rows, 0);
    EXPECT_EQ(reader.findings().rows(), rows);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.place().file, path.string());
    EXPECT_TRUE(error.place().line > 0 || error.found() == "an empty file") << error.what();
    EXPECT_EQ(std::string_view{error.what()}.find('\n'), std::string_view::npos);
    return false;
  }
}

class MutatedFile : public ::testing::TestWithParam<const char*> {};

TEST_P(MutatedFile, GivesRowsOrAnErrorThatNamesFileAndLine) {
  const zerorate::testing::ScratchFolder folder;
  const std::string valid = valid_bytes(GetParam());
  ASSERT_TRUE(reads_or_explains(folder.write(GetParam(), valid)));
  std::mt19937_64 random{20'240'501};
  constexpr int kMutations = 2'000;
  int read = 0;
  for (int i = 0; i < kMutations && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    read += reads_or_explains(folder.write(GetParam(), mutated(valid, random))) ? 1 : 0;
  }
  EXPECT_LT(read, kMutations) << "no mutation was ever noticed";
}

INSTANTIATE_TEST_SUITE_P(Of, MutatedFile, ::testing::Values("run.csv", "run.csv.gz"),
                         [](const auto& tested) {
                           return std::string{tested.param}.ends_with("gz") ? "Gzip" : "Text";
                         });

}  // namespace
}  // namespace zerorate::recording
