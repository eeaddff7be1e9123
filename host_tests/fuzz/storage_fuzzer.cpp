// Two slots that hold anything: a record no longer than the room for it, or an error; and what is
// saved after that comes back.

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "hal/cortex_m/flash_storage.hpp"
#include "hal/linux/file_storage.hpp"
#include "host_tests/fuzz/fuzz.hpp"
#include "host_tests/support/cut_flash.hpp"

namespace {

using namespace zerorate;
using Bytes = std::vector<std::uint8_t>;

/// Files that live in memory, by name; what is opened for writing is empty at first.
class MemoryFiles : public hal::linux_os::FileCalls {
 public:
  std::array<Bytes, 2> slots;
  std::array<bool, 2> exist{};

  hal::linux_os::CallResult open(const char* path, int flags, unsigned) override {
    const std::string name = path;
    const bool is_new = name.ends_with(".new");
    if ((flags & O_DIRECTORY) != 0) return kFolder;
    slot_ = name.find(".1") != std::string::npos ? 1 : 0;
    if (is_new) {
      written_.clear();
      return kNewFile;
    }
    if (!exist.at(slot_)) return core::Unexpected{ENOENT};
    read_ = 0;
    return kOldFile;
  }
  hal::linux_os::CallResult read(int, std::span<std::uint8_t> out) override {
    const std::span<const std::uint8_t> rest = std::span{slots.at(slot_)}.subspan(read_);
    const std::size_t count = std::min(rest.size(), out.size());
    std::ranges::copy(rest.first(count), out.begin());
    read_ += count;
    return static_cast<int>(count);
  }
  hal::linux_os::CallResult write(int, std::span<const std::uint8_t> bytes) override {
    written_.insert(written_.end(), bytes.begin(), bytes.end());
    return static_cast<int>(bytes.size());
  }
  hal::linux_os::CallResult sync(int) override { return 0; }
  hal::linux_os::CallResult rename(const char*, const char*) override {
    slots.at(slot_) = written_;
    exist.at(slot_) = true;
    return 0;
  }
  void close(int) override {}

 private:
  static constexpr int kFolder = 3;
  static constexpr int kNewFile = 4;
  static constexpr int kOldFile = 5;
  std::size_t slot_ = 0;
  std::size_t read_ = 0;
  Bytes written_;
};

void exercise(hal::Storage auto& storage) {
  std::array<std::uint8_t, 600> room{};
  if (const auto size = storage.load(room)) {
    fuzz::promise(*size <= room.size(), "a record is no longer than the room for it");
  }
  const std::array<std::uint8_t, 5> record{1, 2, 3, 4, 5};
  if (!storage.save(record)) return;
  const auto size = storage.load(room);
  fuzz::promise(size && std::ranges::equal(std::span{room}.first(*size), record),
                "what was saved comes back");
}

void in_files(FuzzedDataProvider& input) {
  MemoryFiles files;
  for (std::size_t i = 0; i < files.slots.size(); ++i) {
    files.exist.at(i) = input.ConsumeBool();
    files.slots.at(i) =
        input.ConsumeBytes<std::uint8_t>(input.ConsumeIntegralInRange<std::size_t>(0, 700));
  }
  hal::linux_os::FileStorage storage("record", files);
  exercise(storage);
}

void in_flash(FuzzedDataProvider& input) {
  using zerorate::testing::CutFlash;
  CutFlash::reset();
  constexpr std::size_t kPlaceBytes = CutFlash::kSectorBytes / 4;
  for (std::size_t place = 0; place < 8; ++place) {
    const auto bytes =
        input.ConsumeBytes<std::uint8_t>(input.ConsumeIntegralInRange<std::size_t>(0, 64));
    std::ranges::copy(bytes, CutFlash::bytes.begin() + std::ptrdiff_t(place * kPlaceBytes));
  }
  hal::cortex_m::FlashStorage<CutFlash, 0> storage;
  exercise(storage);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input(data, size);
  if (input.ConsumeBool()) {
    in_files(input);
  } else {
    in_flash(input);
  }
  return 0;
}
