#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/recording/writer.hpp"

namespace zerorate::recording {
namespace {

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
      case 3:
        bytes.insert(at, bytes.substr(pick(bytes.size()), 1 + pick(60)));
        break;
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
