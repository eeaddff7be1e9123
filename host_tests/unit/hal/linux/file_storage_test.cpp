#include "hal/linux/file_storage.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "host_tests/support/allocation_counter.hpp"
#include "host_tests/support/folders.hpp"

namespace zerorate::hal::linux_os {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Real files; the n-th call that changes something, and all after it, fail and do nothing, as if
/// the supply had been cut. Or only the n-th fails, with an error.
class FailingCalls : public FileCalls {
 public:
  std::optional<int> cut_at;
  std::optional<int> error_at;
  int error = EIO;
  std::size_t longest_write = 4096;
  int changes = 0;

  CallResult open(const char* path, int flags, unsigned mode) override {
    if (const auto failure = (flags & O_CREAT) != 0 ? change() : std::nullopt) return *failure;
    return FileCalls::open(path, flags, mode);
  }
  CallResult write(int descriptor, std::span<const std::uint8_t> bytes) override {
    if (const auto failure = change()) {
      // Only a part reached the medium before the cut.
      (void)FileCalls::write(descriptor, bytes.first(bytes.size() / 2));
      return *failure;
    }
    return FileCalls::write(descriptor, bytes.first(std::min(bytes.size(), longest_write)));
  }
  CallResult sync(int descriptor) override {
    if (const auto failure = change()) return *failure;
    return FileCalls::sync(descriptor);
  }
  CallResult rename(const char* from, const char* to) override {
    if (const auto failure = change()) return *failure;
    return FileCalls::rename(from, to);
  }

 private:
  std::optional<CallResult> change() {
    const int number = changes++;
    if (cut_at && number >= *cut_at) return CallResult{core::Unexpected{EIO}};
    if (error_at && number == *error_at) return CallResult{core::Unexpected{error}};
    return std::nullopt;
  }
};

struct Rig {
  testing::ScratchFolder folder;
  FailingCalls calls;
  std::string path = (folder.path() / "state").string();
  FileStorage storage{path, calls};

  /// Loads the record as a program that has just been started does.
  core::Result<std::size_t, StorageError> load_afresh(Bytes& record) {
    FileCalls healthy;
    FileStorage fresh{path, healthy};
    record.assign(8192, 0);
    const auto size = fresh.load(record);
    if (size) record.resize(*size);
    return size;
  }
  void spoil(const std::string& file, std::streamoff at) {
    std::fstream stream{file, std::ios::in | std::ios::out | std::ios::binary};
    stream.seekg(at);
    const auto byte = static_cast<char>(stream.get() ^ 0x10);
    stream.seekp(at);
    stream.put(byte);
  }
};

Bytes record_of(std::uint8_t value) {
  return Bytes(1000, value);
}

TEST(FileStorageThatWasNeverUsed, IsEmpty) {
  Rig rig;
  Bytes record;
  EXPECT_EQ(rig.load_afresh(record).error(), StorageError::empty);
}

TEST(FileStorage, GivesBackTheNewestOfManyRecords) {
  Rig rig;
  Bytes record;
  for (std::uint8_t value = 1; value <= 7; ++value) {
    ASSERT_TRUE(rig.storage.save(record_of(value)));
    ASSERT_TRUE(rig.load_afresh(record));
    EXPECT_EQ(record, record_of(value));
  }
}

TEST(FileStorageAfterARestart, GoesOnFromTheNewestRecord) {
  Rig rig;
  for (std::uint8_t value = 1; value <= 5; ++value) {
    FileStorage fresh{rig.path, rig.calls};
    ASSERT_TRUE(fresh.save(record_of(value)));
  }
  Bytes record;
  ASSERT_TRUE(rig.load_afresh(record));
  EXPECT_EQ(record, record_of(5));
}

/// Verifies SR-SNAP-09.
TEST(FileStorageCutOffAtAnyMoment, HasEitherTheOldRecordOrTheNew) {
  bool is_over = false;
  for (int cut = 0; !is_over; ++cut) {
    Rig rig;
    ASSERT_TRUE(rig.storage.save(record_of(1)));
    ASSERT_TRUE(rig.storage.save(record_of(2)));
    rig.calls.changes = 0;
    rig.calls.cut_at = cut;
    rig.calls.longest_write = 300;
    const auto saved = rig.storage.save(record_of(3));
    is_over = rig.calls.changes <= cut;
    Bytes record;
    ASSERT_TRUE(rig.load_afresh(record)) << cut;
    EXPECT_TRUE(record == record_of(2) || record == record_of(3)) << cut;
    if (saved) {
      EXPECT_EQ(record, record_of(3)) << cut;
    }
    // And the next save after the cut does not destroy what is there before it is done.
    rig.calls.cut_at.reset();
    ASSERT_TRUE(rig.storage.save(record_of(4))) << cut;
    ASSERT_TRUE(rig.load_afresh(record)) << cut;
    EXPECT_EQ(record, record_of(4)) << cut;
  }
}

TEST(FileStorageOnAFullMedium, SaysSoAndKeepsTheRecordBefore) {
  for (const int call : {0, 1, 2, 3}) {  // creating the file, header, record, fsync
    Rig rig;
    ASSERT_TRUE(rig.storage.save(record_of(1)));
    rig.calls.changes = 0;
    rig.calls.error_at = call;
    rig.calls.error = ENOSPC;
    EXPECT_EQ(rig.storage.save(record_of(2)).error(), StorageError::full) << call;
    Bytes record;
    ASSERT_TRUE(rig.load_afresh(record));
    EXPECT_EQ(record, record_of(1));
    EXPECT_TRUE(rig.storage.save(record_of(3)));  // there is space again
    ASSERT_TRUE(rig.load_afresh(record));
    EXPECT_EQ(record, record_of(3));
  }
}

TEST(FileStorageWhoseNewestSlotIsSpoilt, GivesTheOneBefore) {
  for (const std::streamoff at : {0, 5, 9, 17, 20, 700, 1019}) {
    Rig rig;
    ASSERT_TRUE(rig.storage.save(record_of(1)));
    ASSERT_TRUE(rig.storage.save(record_of(2)));  // generation 2 lies in slot 0
    rig.spoil(rig.path + ".0", at);
    Bytes record;
    ASSERT_TRUE(rig.load_afresh(record)) << at;
    EXPECT_EQ(record, record_of(1)) << at;
  }
}

TEST(FileStorageWithBothSlotsSpoilt, SaysThatItIsCorrupt) {
  Rig rig;
  ASSERT_TRUE(rig.storage.save(record_of(1)));
  ASSERT_TRUE(rig.storage.save(record_of(2)));
  rig.spoil(rig.path + ".0", 100);
  rig.spoil(rig.path + ".1", 100);
  Bytes record;
  EXPECT_EQ(rig.load_afresh(record).error(), StorageError::corrupt);
}

TEST(FileStorageWithATruncatedSlot, GivesTheOther) {
  Rig rig;
  ASSERT_TRUE(rig.storage.save(record_of(1)));
  ASSERT_TRUE(rig.storage.save(record_of(2)));
  std::filesystem::resize_file(rig.path + ".0", 500);
  Bytes record;
  ASSERT_TRUE(rig.load_afresh(record));
  EXPECT_EQ(record, record_of(1));
}

TEST(FileStorageWithTooSmallABuffer, SaysSo) {
  Rig rig;
  ASSERT_TRUE(rig.storage.save(record_of(1)));
  Bytes small(999);
  EXPECT_EQ(rig.storage.load(small).error(), StorageError::too_large);
}

TEST(FileStorageInAFolderThatIsNotThere, FailsWithoutARecord) {
  FileCalls calls;
  FileStorage storage{"/there/is/no/such/folder/state", calls};
  EXPECT_EQ(storage.save(record_of(1)).error(), StorageError::io);
}

TEST(FileStorageOnceMade, DoesNotAllocate) {
  Rig rig;
  const Bytes record = record_of(9);
  Bytes buffer(8192);
  const support::AllocationCounter allocations;
  EXPECT_TRUE(rig.storage.save(record));
  EXPECT_TRUE(rig.storage.load(buffer));
  EXPECT_EQ(allocations.count(), 0U);
}

}  // namespace
}  // namespace zerorate::hal::linux_os
