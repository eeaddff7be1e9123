/// @file
/// Selection of the measurements to learn from: samples and odometer pulses in, certain ticks out.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/base/time.hpp"
#include "core/monitor/odometer_check.hpp"
#include "core/samples/tick_average.hpp"
#include "core/samples/white_level.hpp"
#include "core/standstill/calm_judge.hpp"
#include "core/standstill/hold_back_line.hpp"
#include "core/standstill/standstill.hpp"
#include "core/standstill/sway_mean.hpp"

namespace zerorate::core {

/// Averages the samples of a standstill over ticks, holds the ticks back, and confirms those that
/// certainly belong to the standstill:
///
///     sample ---> averaged ---> held back ---> confirmed ---> taken
///        |           |             |
///        |           |             +-- discarded: a pulse follows within the hold-back, or the
///        |           |                 gyro shows motion within 1.5 s (the newest ticks), or a
///        |           |                 turn without pulses (all held ticks)
///        |           +-- discarded: a pulse comes before the tick is over
///        +-- discarded: less than the settle time after a pulse
///
/// Without an odometer there are no pulses, and CalmJudge alone decides. With an odometer alone
/// every stop is rest, whatever the gyro shows.
///
/// In a stop that is never calm the vehicle may sway. Where its mean rate teaches more than is
/// known, that is confirmed in place of the ticks, with the error that it has (SwayMean).
///
/// @tparam Item a TickMean<Axes> with members `bool begins_stop`, `has_jumped` and `is_sway`;
///   it may hold more
/// @tparam Capacity number of ticks that are held at most
/// @tparam HasAccelerometer whether the specific force is a witness of motion too
template <class Item, std::size_t Axes, std::size_t Capacity, bool HasAccelerometer = false>
class StopLearning {
 public:
  using Rates = std::array<float, Axes>;
  using Judge = CalmJudge<Axes, WitnessOf<HasAccelerometer>>;
  using Force = typename Judge::Force;
  using HoldBack = HoldBackLine<Item, Capacity>;
  using White = WhiteLevel<Axes>;

  struct State {
    Instant newest_sample;
    bool has_sample = false;
    bool stop_is_open = false;  ///< the next tick belongs to the stop of the newest confirmed one
    Standstill::State standstill;
    typename OdometerCheck<Axes>::State odometer;
    typename TickAverage<Axes>::State average;
    typename Judge::State calm;
    typename SwayMean<Axes>::State sway;
    float sway_variance_rad2_s2 = 0.0F;
    HoldBack held;

    constexpr bool operator==(const State&) const = default;
  };

  /// @param standstill must outlive this
  /// @param white_variance_rad2_s2 of one sample
  constexpr StopLearning(const Standstill::Params& standstill, const OdometerCheckParams& odometer,
                         Duration tick, Duration sample_period, float white_variance_rad2_s2)
      : standstill_(standstill),
        odometer_(limits_for(standstill.source, odometer), tick, sample_period,
                  white_variance_rad2_s2),
        average_(tick, sample_period),
        calm_(standstill.source, odometer.longest_bend, tick),
        sway_(tick),
        has_odometer_(standstill.source != StandstillSource::gyro),
        asks_gyro_(standstill.source != StandstillSource::odometer_alone),
        wait_(longest_wait(standstill, tick) + sample_period / 2),
        most_waiting_(static_cast<std::size_t>(
            std::min(wait_ / tick + 2, static_cast<std::int64_t>(Capacity) - 2))) {}

  [[nodiscard]] constexpr State state() const {
    return {
        newest_sample_,   has_sample_,   stop_is_open_, standstill_.state(),    odometer_.state(),
        average_.state(), calm_.state(), sway_.state(), sway_variance_rad2_s2_, held_};
  }
  /// @param white level of the node that the state belongs to
  constexpr void restore(const State& state, const White& white) {
    newest_sample_ = state.newest_sample;
    has_sample_ = state.has_sample;
    stop_is_open_ = state.stop_is_open;
    standstill_.restore(state.standstill);
    odometer_.restore(state.odometer);
    average_.restore(state.average);
    calm_.restore(state.calm);
    sway_.restore(state.sway);
    sway_variance_rad2_s2_ = state.sway_variance_rad2_s2;
    odometer_.set_white_noise(white.upper_variance_rad2_s2());
    held_ = state.held;
  }

  /// True if a restored state is valid: one that no input leads to could fill the line of held
  /// ticks, or count beyond its clock.
  /// @param is_possible_item the same of what an Item holds beside its mean
  template <class IsPossible>
  [[nodiscard]] static bool is_possible(const State& state, Duration tick,
                                        IsPossible is_possible_item) {
    return are_bools(state.has_sample, state.stop_is_open) && is_in_range(state.newest_sample) &&
           Standstill::is_possible(state.standstill) &&
           OdometerCheck<Axes>::is_possible(state.odometer) && Judge::is_possible(state.calm) &&
           SwayMean<Axes>::is_possible(state.sway) &&
           is_plausible_variance(state.sway_variance_rad2_s2) &&
           TickAverage<Axes>::is_possible(state.average, tick, state.has_sample,
                                          state.newest_sample) &&
           state.held.is_possible([&](const Item& item, const Item* before) {
             return TickAverage<Axes>::is_possible(state.average, item, state.newest_sample) &&
                    (before == nullptr || (before->tick < item.tick && before->end < item.end)) &&
                    are_bools(item.begins_stop, item.has_jumped, item.is_sway) &&
                    is_possible_item(item);
           });
  }

  /// An odometer pulse; before the sample that is not older. The ticks that are certain already are
  /// confirmed now, because after the pulse they would count as a new stop.
  constexpr void pulse(Instant at) {
    if (!has_odometer_) return;
    confirm_until(standstill_.discard_after(at));
    held_.discard_after(standstill_.discard_after(at));
    odometer_.pulse(at - standstill_.state().last_pulse);
    end_stop(at);
  }

  /// The vehicle moves, and it is unknown since when: no tick that is held is certain any more.
  constexpr void report_odometer_fault(Instant now) {
    if (has_odometer_) interrupt(now);
  }
  /// Ends the stop, and discards what is held of it.
  constexpr void interrupt(Instant now) {
    held_.discard_held();
    odometer_.interrupt();
    end_stop(now);
  }

  [[nodiscard]] constexpr bool has_sample() const { return has_sample_; }
  [[nodiscard]] constexpr Instant newest_sample() const { return newest_sample_; }
  /// False for a time that is not after the newest sample, or that no tick can be given.
  [[nodiscard]] constexpr bool can_take(Instant at) const {
    return !(has_sample_ && at <= newest_sample_) && average_.can_take(at);
  }

  /// A sample arrives. For each: begin_sample(), close_tick() and enter_tick() if it begins a tick,
  /// add(), confirm_at().
  /// @return whether it begins a tick
  constexpr bool begin_sample(Instant at) {
    const bool begins_tick = !has_sample_ || average_.is_over_at(at);
    newest_sample_ = at;
    has_sample_ = true;
    standstill_.start(at);
    return begins_tick;
  }

  /// Queues the tick that is over, if it was calm; discards what motion spoils (see above).
  /// @param force specific force of that tick
  /// @param predicted_rad_s the bias, or nullptr if none is known
  /// @param variance_rad2_s2 variance of that prediction
  /// @param measurement makes an Item of the mean of the tick
  template <class Measurement>
  constexpr void close_tick(const Force& force, const Rates* predicted_rad_s,
                            float variance_rad2_s2, White& white, Measurement measurement) {
    if (average_.is_empty()) return;
    const Item closed = measurement(average_.close());
    // Without an odometer no level was said to be rest, and none is less likely than another.
    constexpr float kAnyLevel = std::numeric_limits<float>::infinity();
    odometer_.on_standing_tick(closed.rate_rad_s, closed.samples, predicted_rad_s,
                               has_odometer_ ? variance_rad2_s2 : kAnyLevel);
    const Calm calm = judge(closed, force, predicted_rad_s, variance_rad2_s2, white);
    odometer_.take_verdict(calm == Calm::far);
    odometer_.set_white_noise(white.upper_variance_rad2_s2());
    if (odometer_.turns()) {
      held_.discard_held();
    } else if (calm == Calm::calm) {
      held_.push(closed);
    } else if (calm == Calm::moved) {
      held_.discard_newest_while(
          [&](const Item& item) { return item.tick + calm_.reach_ticks() > closed.tick; });
    }
    if (has_odometer_ && asks_gyro_) take_sway(closed, predicted_rad_s, variance_rad2_s2);
  }
  constexpr void enter_tick(Instant at) { average_.enter(at); }

  /// Adds the sample to the tick being filled, if the vehicle stands.
  /// @param is_usable asked for each sample at standstill: whether it may be learnt from
  template <class IsUsable>
  constexpr void add(Instant at, bool begins_tick, const Rates& rate_rad_s, IsUsable is_usable) {
    if (!standstill_.is_settled(at)) {
      if (begins_tick) odometer_.on_driving_tick(rate_rad_s);
    } else if (is_usable()) {
      average_.add(at, rate_rad_s);
      calm_.add(rate_rad_s);
    }
  }

  /// Confirms the ticks that are certain by the newest sample. After close_tick(): with a hold-back
  /// of one tick this is a sample later.
  constexpr void confirm_at(Instant now) {
    if (held_.size() > held_.confirmed()) confirm_until(now - wait_);
  }
  /// Number of ticks that are certain and wait to be taken.
  [[nodiscard]] constexpr std::size_t confirmed() const { return held_.confirmed(); }
  /// Takes the oldest certain tick.
  [[nodiscard]] constexpr Item take_confirmed() { return held_.take_confirmed(); }
  /// Variance of the error of the newest mean of a vehicle that sways.
  [[nodiscard]] constexpr float sway_variance_rad2_s2() const { return sway_variance_rad2_s2_; }
  /// Whether more ticks wait than a pulse confirms at once: the samples that should have shared
  /// their work did not come.
  [[nodiscard]] constexpr bool is_behind() const { return held_.confirmed() > most_waiting_; }

  /// Never still while the gyro shows motion or a turn without pulses: nothing is learnt then.
  /// Without an odometer that is what moving means.
  [[nodiscard]] constexpr Motion motion() const {
    const Motion motion = standstill_.motion(newest_sample_);
    const bool is_calm = (calm_.is_calm() || !asks_gyro_) && !odometer_.turns();
    if (!has_odometer_ && !is_calm) return Motion::moving;
    return motion == Motion::still && !is_calm ? Motion::settling : motion;
  }
  [[nodiscard]] constexpr bool odometer_disagrees() const {
    return has_odometer_ && odometer_.disagrees();
  }
  [[nodiscard]] constexpr bool has_dead_band() const {
    return has_odometer_ && calm_.share().has_dead_band();
  }
  [[nodiscard]] constexpr const Judge& calm() const { return calm_; }
  /// The tick being filled, counted from the first one.
  [[nodiscard]] constexpr std::uint32_t tick() const { return average_.tick(); }
  [[nodiscard]] constexpr std::uint32_t tick_of(Instant at) const { return average_.tick_of(at); }

 private:
  /// With an odometer alone no rotation is a turn that it missed.
  static constexpr OdometerCheckParams limits_for(StandstillSource source,
                                                  OdometerCheckParams limits) {
    if (source == StandstillSource::odometer_alone) {
      limits.turn_rad_s = std::numeric_limits<float>::infinity();
    }
    return limits;
  }
  /// Adds a tick to the mean of a vehicle that sways, and confirms that mean in place of what is
  /// held, if it is certain enough and contradicts nothing.
  [[gnu::noinline]] constexpr void take_sway(const Item& closed, const Rates* predicted_rad_s,
                                             float predicted_rad2_s2) {
    sway_.add(closed.rate_rad_s);
    if (!sway_.is_complete() || !sway_.sways()) return;
    const float variance = sway_.variance_rad2_s2();
    if (predicted_rad_s != nullptr) {
      const bool teaches = variance < predicted_rad2_s2;
      constexpr float kNear2 = 3.0F * 3.0F;
      const float limit = kNear2 * (variance + predicted_rad2_s2);
      if (!teaches || !are_near(sway_.mean_rad_s(), *predicted_rad_s, limit)) return;
    }
    Item mean = closed;
    mean.rate_rad_s = sway_.mean_rad_s();
    mean.is_sway = true;
    sway_variance_rad2_s2_ = variance;
    held_.discard_held();
    held_.push(mean);
    confirm_until(closed.end);
  }
  /// A level that has lasted over several stops is believed, however far it is.
  constexpr Calm judge(const Item& closed, const Force& force, const Rates* predicted_rad_s,
                       float variance_rad2_s2, White& white) {
    const Calm judged = calm_.judge(closed, force, predicted_rad_s, variance_rad2_s2, white);
    const bool is_settled = has_odometer_ && odometer_.is_accepted();
    if (!asks_gyro_ || (judged == Calm::far && is_settled)) return Calm::calm;
    return judged;
  }
  /// Wait of a tick until nothing can speak against it any more: neither a late pulse nor motion
  /// that the two windows after it show, as far as there is room.
  static constexpr Duration longest_wait(const Standstill::Params& standstill, Duration tick) {
    constexpr auto kRoom = static_cast<std::int64_t>(Capacity) - kPlacesOfWork;
    return std::max(standstill.hold_back, tick * std::min(Judge::ticks_of_verdict(tick), kRoom));
  }
  /// Not inlined: it is called at two places, and a board counts bytes.
  [[gnu::noinline]] constexpr void confirm_until(Instant certain) {
    held_.confirm_until(certain, [&](Item& item) {
      sway_.clear();
      item.begins_stop = !stop_is_open_;
      stop_is_open_ = true;
      item.has_jumped = has_odometer_ && odometer_.take_jump();
    });
  }

  constexpr void end_stop(Instant pulse) {
    standstill_.pulse(pulse);
    average_.clear();
    calm_.end_stop();
    sway_.clear();
    stop_is_open_ = false;
  }

  Instant newest_sample_;
  Standstill standstill_;
  OdometerCheck<Axes> odometer_;
  TickAverage<Axes> average_;
  Judge calm_;
  SwayMean<Axes> sway_;
  float sway_variance_rad2_s2_ = 0.0F;
  bool has_sample_ = false;
  bool stop_is_open_ = false;
  bool has_odometer_;
  bool asks_gyro_;
  Duration wait_;             ///< time of a tick until it is certain
  std::size_t most_waiting_;  ///< certain ticks that wait at most
  HoldBack held_;
};

}  // namespace zerorate::core
