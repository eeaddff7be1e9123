/// @file
/// A record in memory, on a medium that can be full or break.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/result.hpp"
#include "hal/contract/storage.hpp"

namespace zerorate::hal::sim {

/// A Storage of limited size; while an error is set, every save fails with it.
class SimulatedStorage {
 public:
  explicit SimulatedStorage(std::size_t capacity = 65536) : capacity_(capacity) {}

  void set_error(std::optional<StorageError> error) { error_ = error; }
  [[nodiscard]] std::size_t saves() const { return saves_; }

  core::Result<std::size_t, StorageError> load(std::span<std::uint8_t> buffer) {
    if (!record_) return core::Unexpected{StorageError::empty};
    if (record_->size() > buffer.size()) return core::Unexpected{StorageError::too_large};
    std::ranges::copy(*record_, buffer.begin());
    return record_->size();
  }

  core::Result<void, StorageError> save(std::span<const std::uint8_t> record) {
    if (error_) return core::Unexpected{*error_};
    if (record.size() > capacity_) return core::Unexpected{StorageError::too_large};
    record_.emplace(record.begin(), record.end());
    ++saves_;
    return {};
  }

 private:
  std::size_t capacity_;
  std::optional<StorageError> error_;
  std::optional<std::vector<std::uint8_t>> record_;
  std::size_t saves_ = 0;
};
static_assert(Storage<SimulatedStorage>);

}  // namespace zerorate::hal::sim
