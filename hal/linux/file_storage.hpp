/// @file
/// A record in two files, of which one is always whole.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/base/result.hpp"
#include "hal/contract/storage.hpp"
#include "hal/linux/device_file.hpp"

namespace zerorate::hal::linux_os {

/// The calls that FileStorage makes. Virtual, so that a test can fail the n-th: saving is rare and
/// slow anyway.
class FileCalls {
 public:
  FileCalls() = default;
  FileCalls(const FileCalls&) = delete;
  FileCalls& operator=(const FileCalls&) = delete;
  virtual ~FileCalls() = default;

  virtual CallResult open(const char* path, int flags, unsigned mode);
  virtual CallResult read(int descriptor, std::span<std::uint8_t> out);
  virtual CallResult write(int descriptor, std::span<const std::uint8_t> bytes);
  virtual CallResult sync(int descriptor);
  virtual CallResult rename(const char* from, const char* to);
  virtual void close(int descriptor);
};

/// A Storage in the files PATH.0 and PATH.1, written in turn: into PATH.N.new, fsync, rename onto
/// PATH.N, fsync of the folder. A cut at any moment leaves the other slot as it was; a slot that
/// the medium has spoilt is found by its checksum, and the other one is taken.
///
/// Each file is a header of 20 bytes, all little-endian, and the record:
/// "ZRS1", size (4), generation (8), CRC-32 of all before and after it (4).
/// No heap after construction. Blocks for as long as the medium takes.
class FileStorage {
 public:
  static constexpr std::size_t kLargestRecord = std::size_t{1} << 20U;

  /// @param calls must outlive the storage
  FileStorage(const std::string& path, FileCalls& calls);

  core::Result<std::size_t, StorageError> load(std::span<std::uint8_t> buffer);
  /// The first call reads both slots to learn which one is the newer.
  core::Result<void, StorageError> save(std::span<const std::uint8_t> record);
  /// Reason of the newest save that failed as the kernel gave it; 0: it gave none.
  [[nodiscard]] int error_number() const { return error_number_; }

 private:
  static constexpr std::size_t kSlots = 2;
  struct Slot {
    std::string path;
    std::string path_while_written;
  };
  struct Content {
    std::uint64_t generation = 0;
    std::size_t size = 0;
  };

  core::Unexpected<StorageError> failed(int error);
  core::Result<Content, StorageError> read_slot(const Slot& slot, std::span<std::uint8_t> buffer);
  core::Result<Content, StorageError> read_open(int descriptor, std::span<std::uint8_t> buffer);
  core::Result<void, StorageError> write_slot(const Slot& slot, std::uint64_t generation,
                                              std::span<const std::uint8_t> record);
  core::Result<void, StorageError> write_all(int descriptor, std::span<const std::uint8_t> bytes);
  core::Result<void, StorageError> sync_folder();
  core::Result<std::uint64_t, StorageError> newest_generation();

  FileCalls* calls_;
  std::array<Slot, kSlots> slots_;
  std::string folder_;
  std::optional<std::uint64_t> newest_;
  int error_number_ = 0;
};
static_assert(Storage<FileStorage>);

}  // namespace zerorate::hal::linux_os
