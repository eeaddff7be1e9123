/// @file
/// What hal/contract promises of Storage, over every back end.

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "hal/linux/file_storage.hpp"
#include "hal/sim/storage.hpp"
#include "host_tests/support/scratch_folder.hpp"

namespace zerorate::hal {
namespace {

struct InMemory {
  sim::SimulatedStorage medium;
};
struct InFiles {
  testing::ScratchFolder folder;
  linux_os::FileCalls calls;
  linux_os::FileStorage medium{(folder.path() / "record").string(), calls};
};

template <class BackEnd>
class StorageContract : public ::testing::Test {
 protected:
  core::Result<void, StorageError> save(std::size_t size, std::uint8_t value) {
    return back_end_.medium.save(std::vector<std::uint8_t>(size, value));
  }
  core::Result<std::size_t, StorageError> load(std::size_t room) {
    buffer_.assign(room, 0);
    return back_end_.medium.load(buffer_);
  }
  std::vector<std::uint8_t> buffer_;
  BackEnd back_end_;
};
using BackEnds = ::testing::Types<InMemory, InFiles>;
TYPED_TEST_SUITE(StorageContract, BackEnds);

TYPED_TEST(StorageContract, IsEmptyAtFirst) {
  EXPECT_EQ(this->load(10).error(), StorageError::empty);
}

TYPED_TEST(StorageContract, GivesBackTheNewestRecordWithItsSize) {
  ASSERT_TRUE(this->save(100, 1));
  ASSERT_TRUE(this->save(7, 2));
  const auto size = this->load(200);
  ASSERT_TRUE(size);
  EXPECT_EQ(*size, 7U);
  EXPECT_EQ(this->buffer_[6], 2);
}

TYPED_TEST(StorageContract, SaysThatABufferIsTooSmall) {
  ASSERT_TRUE(this->save(100, 1));
  EXPECT_EQ(this->load(99).error(), StorageError::too_large);
  EXPECT_TRUE(this->load(100));
}

TYPED_TEST(StorageContract, RefusesARecordThatDoesNotFitAndKeepsTheOneBefore) {
  ASSERT_TRUE(this->save(5, 3));
  EXPECT_EQ(this->save((std::size_t{1} << 20U) + 1, 4).error(), StorageError::too_large);
  EXPECT_EQ(*this->load(100), 5U);
}

}  // namespace
}  // namespace zerorate::hal
