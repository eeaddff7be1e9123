#include "hal/linux/file_storage.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/base/crc32.hpp"

namespace zerorate::hal::linux_os {
namespace {

constexpr std::size_t kHeaderBytes = 20;
constexpr std::size_t kChecksumAt = 16;
constexpr std::uint32_t kMagic = 0x3153525A;  // "ZRS1"
using Header = std::array<std::uint8_t, kHeaderBytes>;

void put(std::span<std::uint8_t> target, std::uint64_t value) {
  for (std::uint8_t& byte : target) {
    byte = static_cast<std::uint8_t>(value);
    value >>= 8U;
  }
}

std::uint64_t get(std::span<const std::uint8_t> source) {
  std::uint64_t value = 0;
  for (std::size_t i = source.size(); i > 0; --i) value = value << 8U | source[i - 1];
  return value;
}

std::uint32_t checksum(const Header& header, std::span<const std::uint8_t> record) {
  return core::crc32(record, core::crc32(std::span{header}.first<kChecksumAt>()));
}

Header make_header(std::uint64_t generation, std::span<const std::uint8_t> record) {
  Header header{};
  put(std::span{header}.subspan<0, 4>(), kMagic);
  put(std::span{header}.subspan<4, 4>(), record.size());
  put(std::span{header}.subspan<8, 8>(), generation);
  put(std::span{header}.subspan<kChecksumAt, 4>(), checksum(header, record));
  return header;
}

}  // namespace

CallResult FileCalls::open(const char* path, int flags, unsigned mode) {
  return checked(::open(path, flags | O_CLOEXEC, mode));
}
CallResult FileCalls::read(int descriptor, std::span<std::uint8_t> out) {
  return checked(static_cast<int>(::read(descriptor, out.data(), out.size())));
}
CallResult FileCalls::write(int descriptor, std::span<const std::uint8_t> bytes) {
  return checked(static_cast<int>(::write(descriptor, bytes.data(), bytes.size())));
}
CallResult FileCalls::sync(int descriptor) {
  return checked(::fsync(descriptor));
}
CallResult FileCalls::rename(const char* from, const char* to) {
  return checked(std::rename(from, to));
}
void FileCalls::close(int descriptor) {
  (void)::close(descriptor);  // an error here loses nothing: the data are synchronised
}

FileStorage::FileStorage(const std::string& path, FileCalls& calls)
    : calls_(&calls), folder_(std::filesystem::absolute(path).parent_path().string()) {
  for (std::size_t i = 0; i < kSlots; ++i) {
    slots_[i].path = path + "." + std::to_string(i);
    slots_[i].path_while_written = slots_[i].path + ".new";
  }
}

core::Result<std::size_t, StorageError> FileStorage::load(std::span<std::uint8_t> buffer) {
  const auto first = read_slot(slots_[0], buffer);
  const auto second = read_slot(slots_[1], buffer);
  const bool is_first = first && (!second || first->generation > second->generation);
  if (is_first) {
    const auto again = read_slot(slots_[0], buffer);  // the second one lies in the buffer now
    if (!again) return core::Unexpected{again.error()};
    return again->size;
  }
  if (second) return second->size;
  const bool is_empty =
      first.error() == StorageError::empty && second.error() == StorageError::empty;
  if (is_empty) return core::Unexpected{StorageError::empty};
  return core::Unexpected{first.error() == StorageError::empty ? second.error() : first.error()};
}

core::Unexpected<StorageError> FileStorage::failed(int error) {
  error_number_ = error;
  const bool is_full = error == ENOSPC || error == EDQUOT;
  return core::Unexpected{is_full ? StorageError::full : StorageError::io};
}

core::Result<void, StorageError> FileStorage::save(std::span<const std::uint8_t> record) {
  error_number_ = 0;
  if (record.size() > kLargestRecord) return core::Unexpected{StorageError::too_large};
  const auto newest = newest_generation();
  if (!newest) return core::Unexpected{newest.error()};
  const std::uint64_t generation = *newest + 1;
  const auto written = write_slot(slots_[generation % kSlots], generation, record);
  // Whether a save that failed has left the new record is not known: look before the next one.
  newest_.reset();
  if (written) newest_ = generation;
  return written;
}

core::Result<FileStorage::Content, StorageError> FileStorage::read_slot(
    const Slot& slot, std::span<std::uint8_t> buffer) {
  const CallResult opened = calls_->open(slot.path.c_str(), O_RDONLY | O_NONBLOCK, 0);
  if (!opened) {
    return core::Unexpected{opened.error() == ENOENT ? StorageError::empty : StorageError::io};
  }
  const auto content = read_open(*opened, buffer);
  calls_->close(*opened);
  return content;
}

/// Without room for the record (an empty buffer), only its checksum is verified.
core::Result<FileStorage::Content, StorageError> FileStorage::read_open(
    int descriptor, std::span<std::uint8_t> buffer) {
  Header header{};
  const CallResult head = calls_->read(descriptor, header);
  if (!head) return core::Unexpected{StorageError::io};
  const Content content{.generation = get(std::span{header}.subspan<8, 8>()),
                        .size = static_cast<std::size_t>(get(std::span{header}.subspan<4, 4>()))};
  const bool is_ours = *head == kHeaderBytes && get(std::span{header}.first<4>()) == kMagic;
  if (!is_ours || content.size > kLargestRecord) return core::Unexpected{StorageError::corrupt};
  if (!buffer.empty() && content.size > buffer.size()) {
    return core::Unexpected{StorageError::too_large};
  }
  std::uint32_t crc = core::crc32(std::span{header}.first<kChecksumAt>());
  std::array<std::uint8_t, 512> piece{};
  std::size_t done = 0;
  while (done < content.size) {
    const auto room = buffer.empty() ? std::span<std::uint8_t>{piece} : buffer.subspan(done);
    const auto target = room.first(std::min(room.size(), content.size - done));
    const CallResult read = calls_->read(descriptor, target);
    if (!read) return core::Unexpected{StorageError::io};
    if (*read == 0) return core::Unexpected{StorageError::corrupt};
    crc = core::crc32(target.first(static_cast<std::size_t>(*read)), crc);
    done += static_cast<std::size_t>(*read);
  }
  if (crc != get(std::span{header}.subspan<kChecksumAt, 4>())) {
    return core::Unexpected{StorageError::corrupt};
  }
  return content;
}

core::Result<std::uint64_t, StorageError> FileStorage::newest_generation() {
  if (newest_) return *newest_;
  std::uint64_t newest = 0;
  for (const Slot& slot : slots_) {
    const auto content = read_slot(slot, {});
    if (content) newest = std::max(newest, content->generation);
    // A slot that cannot be read might be the newest: writing could destroy it.
    if (!content && content.error() == StorageError::io) return core::Unexpected{StorageError::io};
  }
  return newest;
}

core::Result<void, StorageError> FileStorage::write_slot(const Slot& slot, std::uint64_t generation,
                                                         std::span<const std::uint8_t> record) {
  constexpr unsigned kOwnerOnly = 0600;
  // A link or a FIFO of that name must neither lead elsewhere nor hold up the caller.
  constexpr int kWriteAnew = O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_NONBLOCK;
  const CallResult opened = calls_->open(slot.path_while_written.c_str(), kWriteAnew, kOwnerOnly);
  if (!opened) return failed(opened.error());
  auto written = write_all(*opened, make_header(generation, record));
  if (written) written = write_all(*opened, record);
  if (written) {
    if (const CallResult synced = calls_->sync(*opened); !synced) written = failed(synced.error());
  }
  calls_->close(*opened);
  if (!written) return written;
  const CallResult renamed = calls_->rename(slot.path_while_written.c_str(), slot.path.c_str());
  if (!renamed) return failed(renamed.error());
  return sync_folder();
}

core::Result<void, StorageError> FileStorage::write_all(int descriptor,
                                                        std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const CallResult written = calls_->write(descriptor, bytes);
    if (!written && written.error() == EINTR) continue;
    if (!written) return failed(written.error());
    bytes = bytes.subspan(static_cast<std::size_t>(*written));
  }
  return {};
}

/// The rename is a change of the folder: without this, a power cut may undo it.
core::Result<void, StorageError> FileStorage::sync_folder() {
  const CallResult opened = calls_->open(folder_.c_str(), O_RDONLY | O_DIRECTORY, 0);
  if (!opened) return failed(opened.error());
  const CallResult synced = calls_->sync(*opened);
  calls_->close(*opened);
  if (!synced) return failed(synced.error());
  return {};
}

}  // namespace zerorate::hal::linux_os
