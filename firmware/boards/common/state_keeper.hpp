/// @file
/// Keeps the learnt state of the node while the power is off.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/time.hpp"
#include "core/standstill/standstill.hpp"
#include "firmware/app/snapshot.hpp"
#include "hal/contract/storage.hpp"

namespace zerorate::boards {

/// Saves at the end of a stop from which the node has learnt, at most once a minute: a page of the
/// flash in each turn of the main loop, so that no sample is missed.
/// @tparam Medium  a Storage with prepare() and save_page(): see hal/cortex_m/flash_storage.hpp
template <class Node, hal::Storage Medium>
class StateKeeper {
 public:
  static constexpr core::Duration kShortestPause = core::Duration::seconds(60);

  constexpr StateKeeper(const app::Snapshot<Node>& snapshot, Medium& medium)
      : snapshot_(snapshot), medium_(medium) {}

  /// Call at the start: restores the saved state, if it fits, and makes room for the next save.
  [[gnu::noinline]] void restore(Node& node) {
    // There is no clock on this board, and no place for a reason of refusal: see health's
    // `calibrated`.
    if (const auto record = medium_.newest()) {
      (void)snapshot_.restore_filters(node, *record, {});
    }
    (void)medium_.prepare();
  }

  /// Call after every turn of the main loop.
  /// @return whether the flash was away for longer than a sample takes
  bool poll(Node& node, core::Instant now) {
    if (medium_.is_saving()) {
      (void)medium_.save_page();
      return false;
    }
    const core::Motion motion = node.motion();
    if (motion == core::Motion::still) {
      // Now, while the rate is zero and no sample will be missed.
      const bool is_needed = !is_prepared_;
      was_still_ = is_prepared_ = true;
      return is_needed && medium_.prepare();
    }
    // No call is long: the samples of the next tick finish what the stop taught.
    if (was_still_ && motion == core::Motion::moving && !node.is_learning()) {
      was_still_ = false;
      if (node.measured_ticks() != saved_ticks_ && now >= next_at_) save(node, now);
    }
    return false;
  }

 private:
  [[gnu::noinline]] void save(Node& node, core::Instant now) {
    next_at_ = now + kShortestPause;
    saved_ticks_ = node.measured_ticks();
    is_prepared_ = false;
    // A state that cannot be saved now is saved at the end of another stop.
    snapshot_.write_filters(node, {}, record_);
    (void)medium_.begin_save(record_);
  }

  const app::Snapshot<Node>& snapshot_;
  Medium& medium_;
  core::Instant next_at_;
  std::uint32_t saved_ticks_ = 0;  ///< tick of the newest save
  bool was_still_ = false;
  bool is_prepared_ = true;  ///< restore() did
  /// Here and not on the stack, which is measured for its deepest moment.
  std::array<std::uint8_t, app::Snapshot<Node>::kBytesOfFilters> record_{};
};

}  // namespace zerorate::boards
