#include "firmware/boards/linux/speed_signals.hpp"

#include <algorithm>
#include <cmath>

namespace zerorate::linux_node {
namespace {

bool is_in(const CanFrame& frame, const SpeedSignal& settings) {
  if (settings.signal.id != frame.id) return false;
  if (!settings.multiplexer) return true;
  return raw_signal(settings.multiplexer->signal, frame.payload) == settings.multiplexer->value;
}

}  // namespace

SpeedSignals::SpeedSignals(const std::vector<SpeedSignal>& signals, double dead_band_mps)
    : dead_band_mps_(dead_band_mps) {
  for (const SpeedSignal& settings : signals) {
    signals_.push_back({.settings = settings, .heard_at = {}, .count = {}});
  }
}

bool SpeedSignals::hear(const CanFrame& frame, core::Instant now) {
  was_refused_ = !is_fresh(frame);
  if (was_refused_) return false;
  bool moves = false;
  for (Watched& watched : signals_) {
    if (watched.settings.role == SignalRole::counter || !is_in(frame, watched.settings)) continue;
    moves = hear_signal(watched, frame, now) || moves;
  }
  return moves;
}

bool SpeedSignals::is_fresh(const CanFrame& frame) {
  bool is_fresh = true;
  for (Watched& watched : signals_) {
    if (watched.settings.role != SignalRole::counter || !is_in(frame, watched.settings)) continue;
    const auto count = raw_signal(watched.settings.signal, frame.payload);
    if (!count || count == watched.count) is_fresh = false;
    watched.count = count;
  }
  return is_fresh;
}

bool SpeedSignals::hear_signal(Watched& watched, const CanFrame& frame, core::Instant now) {
  const SpeedSignal& settings = watched.settings;
  const auto count = raw_signal(settings.signal, frame.payload);
  if (!count || (settings.invalid_from && *count >= *settings.invalid_from)) {
    was_refused_ = true;
    return false;
  }
  watched.count = count;
  watched.heard_at = now;
  const auto value = decode_signal(settings.signal, frame.payload);
  return settings.role == SignalRole::speed && value && std::abs(*value) > dead_band_mps_;
}

bool SpeedSignals::is_known(core::Instant now, core::Duration timeout) const {
  return is_valid() && std::ranges::all_of(signals_, [&](const Watched& watched) {
           return watched.settings.role == SignalRole::counter ||
                  (watched.heard_at && now - *watched.heard_at <= timeout);
         });
}

bool SpeedSignals::is_valid() const {
  return std::ranges::all_of(signals_, [](const Watched& watched) {
    return watched.settings.role != SignalRole::valid || !watched.count ||
           *watched.count == watched.settings.valid_value;
  });
}

}  // namespace zerorate::linux_node
