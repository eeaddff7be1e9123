#include <gtest/gtest.h>

#include <string>

#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::recording {
namespace {

TEST(ReaderPastItsHeader, AllocatesNothingHoweverLongTheRecording) {
  const zerorate::testing::ScratchFolder folder;
  std::string text = "t_s,gx_dps,gy_dps,gz_dps,note,temp_c\n";
  for (int i = 0; i < 100'000; ++i) {  // several times the reader's buffers
    text += std::to_string(i) + ".125,0.25,,-1e-3,\"a, b\",25.5\n";
  }
  Reader reader{folder.write("run.csv", text)};
  const support::AllocationCounter allocations;
  for (Row row; reader.next(row);) {
  }
  EXPECT_EQ(allocations.count(), 0);
  EXPECT_EQ(reader.findings().rows(), 100'000);
}

}  // namespace
}  // namespace zerorate::recording
