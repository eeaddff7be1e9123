/// @file
/// Promises of hal/contract about Storage, over every back end.

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "hal/cortex_m/flash_storage.hpp"
#include "hal/linux/file_storage.hpp"
#include "hal/sim/storage.hpp"
#include "host_tests/support/cut_flash.hpp"
#include "host_tests/support/folders.hpp"

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

struct InFlash {
  InFlash() { testing::CutFlash::reset(); }
  cortex_m::FlashStorage<testing::CutFlash, 0> medium;
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
using BackEnds = ::testing::Types<InMemory, InFiles, InFlash>;
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

TYPED_TEST(StorageContract, RefusesATooLongRecordAndKeepsTheOneBefore) {
  ASSERT_TRUE(this->save(5, 3));
  EXPECT_EQ(this->save((std::size_t{1} << 20U) + 1, 4).error(), StorageError::too_large);
  EXPECT_EQ(*this->load(100), 5U);
}

// Tests of a flash alone: every byte that is programmed and every erasure is a step at which
// the power may be cut.

using testing::CutFlash;
using testing::PowerCut;
using FlashStorage = cortex_m::FlashStorage<CutFlash, 0>;

std::vector<std::uint8_t> record_of(int number) {
  return std::vector<std::uint8_t>(600, static_cast<std::uint8_t>(number));
}

/// The number of the record that a storage gives back after a restart; -1: none.
int loaded() {
  std::vector<std::uint8_t> buffer(1024);
  const auto size = FlashStorage{}.load(buffer);
  if (!size) return -1;
  buffer.resize(*size);
  EXPECT_EQ(buffer, record_of(buffer[0]));
  return buffer[0];
}

/// Verifies SR-SNAP-09.
TEST(FlashStorageWhosePowerIsCut, LosesAtMostTheNewestSave) {
  for (int saves_before = 1; saves_before <= 17; ++saves_before) {
    CutFlash::reset();
    for (int number = 0; number < saves_before; ++number) {
      ASSERT_TRUE(FlashStorage{}.save(record_of(number)));
    }
    const auto before = CutFlash::bytes;
    for (std::size_t step = 0;; ++step) {
      CutFlash::bytes = before;
      CutFlash::cut_after(step);
      bool was_cut = false;
      try {
        ASSERT_TRUE(FlashStorage{}.save(record_of(saves_before)));
      } catch (const PowerCut&) {
        was_cut = true;
      }
      CutFlash::cut_never();
      const int found = loaded();
      if (was_cut) {
        ASSERT_TRUE(found == saves_before - 1 || found == saves_before)
            << found << " after step " << step << " of save " << saves_before;
      }
      // And it goes on: two more saves, the first of which may be cut where it hurts.
      ASSERT_TRUE(FlashStorage{}.save(record_of(100)));
      ASSERT_EQ(loaded(), 100);
      if (!was_cut) break;
    }
  }
}

TEST(FlashStorageWhosePowerIsCutAgainAndAgain, KeepsTheNewestOne) {
  CutFlash::reset();
  ASSERT_TRUE(FlashStorage{}.save(record_of(1)));
  int newest = 1;
  for (std::size_t attempt = 0; attempt < 3000; ++attempt) {
    const int next = 2 + static_cast<int>(attempt % 250);
    CutFlash::cut_after(attempt * 7919 % 900);
    try {
      if (FlashStorage{}.save(record_of(next))) newest = next;
    } catch (const PowerCut&) {
    }
    CutFlash::cut_never();
    const int found = loaded();
    ASSERT_TRUE(found == newest || found == next) << "attempt " << attempt;
    newest = found;
  }
}

TEST(FlashStorage, ErasesASectorOnceInFourSavesAndNeverTwoAtOnce) {
  CutFlash::reset();
  for (int number = 0; number < 40; ++number) {
    ASSERT_TRUE(FlashStorage{}.save(record_of(number)));
    EXPECT_EQ(CutFlash::erasures, number < 8 ? 0 : (number - 4) / 4);
  }
}

TEST(FlashStorage, PreparesSoThatTheNextSaveErasesNothing) {
  CutFlash::reset();
  for (int number = 0; number < 40; ++number) {
    const bool was_needed = FlashStorage{}.prepare();
    EXPECT_EQ(was_needed, number >= 8 && number % 4 == 0);
    const int erasures = CutFlash::erasures;
    ASSERT_TRUE(FlashStorage{}.save(record_of(number)));
    EXPECT_EQ(CutFlash::erasures, erasures);
    EXPECT_EQ(loaded(), number);
  }
}

TEST(FlashStorageOnAWornFlash, SaysThatTheRecordDidNotStay) {
  CutFlash::reset();
  ASSERT_TRUE(FlashStorage{}.save(record_of(1)));
  CutFlash::has_stuck_bit = true;
  EXPECT_EQ(FlashStorage{}.save(record_of(2)).error(), StorageError::io);
  CutFlash::has_stuck_bit = false;
  EXPECT_EQ(loaded(), 1);
}

TEST(FlashStorageWithDamagedRecordsOnly, SaysCorruptAndNotEmpty) {
  CutFlash::reset();
  ASSERT_TRUE(FlashStorage{}.save(record_of(1)));
  CutFlash::bytes[100] = 0;
  std::vector<std::uint8_t> buffer(1024);
  EXPECT_EQ(FlashStorage{}.load(buffer).error(), StorageError::corrupt);
}

}  // namespace
}  // namespace zerorate::hal
