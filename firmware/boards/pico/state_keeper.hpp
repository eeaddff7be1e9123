/// @file
/// Keeps what the node has learnt while the power is off.
#pragma once

#include <cstdint>

#include "core/base/time.hpp"
#include "core/standstill/standstill.hpp"
#include "firmware/app/snapshot.hpp"
#include "hal/contract/storage.hpp"

namespace zerorate::pico {

/// Saves at the end of a stop from which the node has learnt, at most once a minute.
/// @tparam Medium  a Storage with prepare(): see hal/rp2040/flash_storage.hpp
template <class Node, hal::Storage Medium>
class StateKeeper {
 public:
  static constexpr core::Duration kShortestPause = core::Duration::seconds(60);

  constexpr StateKeeper(const app::Snapshot<Node>& snapshot, Medium& medium)
      : snapshot_(snapshot), medium_(medium) {}

  /// At the start: gives the node what was kept, if it fits, and makes room for the next save.
  [[gnu::noinline]] void restore(Node& node) {
    // There is no clock on this board, and nobody to tell a refusal to: health says `calibrated`.
    if (const auto record = medium_.newest()) {
      (void)snapshot_.restore_filters(node, *record, {});
    }
    (void)medium_.prepare();
  }

  /// After every turn of the main loop.
  /// @return whether the flash was away for longer than a sample takes
  bool poll(const Node& node, core::Instant now) {
    const core::Motion motion = node.motion();
    if (motion == core::Motion::still) {
      // Now, while the rate is zero and no sample will be missed.
      const bool is_needed = !is_prepared_;
      was_still_ = is_prepared_ = true;
      return is_needed && medium_.prepare();
    }
    if (was_still_ && motion == core::Motion::moving) {
      was_still_ = false;
      if (node.measured_ticks() != saved_ticks_ && now >= next_at_) save(node, now);
    }
    return false;
  }

 private:
  [[gnu::noinline]] void save(const Node& node, core::Instant now) {
    next_at_ = now + kShortestPause;
    saved_ticks_ = node.measured_ticks();
    is_prepared_ = false;
    // A state that cannot be saved now is saved at the end of another stop.
    (void)medium_.save(snapshot_.of_filters(node, {}));
  }

  const app::Snapshot<Node>& snapshot_;
  Medium& medium_;
  core::Instant next_at_;
  std::uint32_t saved_ticks_ = 0;  ///< of the newest save
  bool was_still_ = false;
  bool is_prepared_ = true;  ///< restore() did
};

}  // namespace zerorate::pico
