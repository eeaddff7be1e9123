/// @file
/// References of the heading: where they lie in the turn of a node, and what they teach.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/numeric.hpp"
#include "core/base/time.hpp"
#include "core/base/units.hpp"
#include "core/heading/heading_filter.hpp"
#include "core/heading/recent_turn.hpp"
#include "core/heading/turn_sum.hpp"
#include "firmware/app/rate_message.hpp"

namespace zerorate::app {

/// Heading of the vehicle at a time, counter-clockwise seen from above.
struct HeadingReference {
  core::Instant time;
  core::Angle heading;
  core::Angle sigma;  ///< standard deviation of its error, which no other reference shares
};

/// Angle that the vehicle turned by between two times, whole turns included.
struct TurnReference {
  core::Instant from;
  core::Instant to;
  core::Angle angle;
  core::Angle sigma;
};

/// References of a node, beside the TurnSum that its HeadingFilter follows.
///
/// A reference of the heading lies within the newest two seconds or in the stop that lasts. The
/// ends of a turn may also lie in the stop before the drive, or at the end of the turn before.
/// Fixed memory; cost of a sample: 5 floating-point operations.
template <class TurnSum>
class ReferenceTrack {
 public:
  using Sum = TurnSum;
  using Position = typename Sum::Position;
  using Verdict = core::ReferenceVerdict;

  struct Marks {
    Position followed;  ///< up to where the filter follows
    Position turn_end;  ///< end of the newest turn that was taken
    core::Instant turn_ended = kNever;
    core::Instant departed = kNever;  ///< the newest departure
    core::Instant rested = kNever;    ///< begin of the stop before it
    core::Instant stopped = kNever;   ///< end of the newest motion

    constexpr bool operator==(const Marks&) const = default;
  };
  struct State {
    core::HeadingFilter::State filter;
    core::RecentTurn::State recent;
    Marks marks;

    constexpr bool operator==(const State&) const = default;
  };

  /// @param axis place of the vertical among the axes of the sum
  /// @param sense -1 where that axis points down
  constexpr ReferenceTrack(const core::HeadingFilter::Params& filter, std::size_t axis, float sense)
      : filter_(filter), sense_(sense), axis_(static_cast<std::uint8_t>(axis)) {}

  [[nodiscard]] constexpr State state() const { return {filter_.state(), recent_.state(), marks_}; }
  constexpr void restore(const State& state) {
    filter_.restore(state.filter);
    recent_.restore(state.recent);
    marks_ = state.marks;
  }
  /// Whether memory from outside may be such a state.
  [[nodiscard]] static bool is_possible(const State& state) {
    const auto is_possible_position = [](const Position& position) {
      return core::are_plausible(std::array{position.sum_rad, position.rest_rad, position.length_s,
                                            position.variance_rad2});
    };
    const Marks& marks = state.marks;
    return state.filter.is_possible() && core::RecentTurn::is_possible(state.recent) &&
           is_possible_position(marks.followed) && is_possible_position(marks.turn_end) &&
           std::ranges::all_of(
               std::array{marks.turn_ended, marks.departed, marks.rested, marks.stopped},
               core::is_in_range);
  }

  [[nodiscard]] constexpr const core::HeadingFilter& filter() const { return filter_; }
  /// Variance of the error of the turn of that axis, beside that of the bias at rest and the noise.
  [[nodiscard]] constexpr float scale_variance_rad2(const Sum& sum) const {
    return filter_.driven_variance_rad2(between({}, sum.position(axis_)));
  }
  /// Heading at the newest sample.
  [[nodiscard]] constexpr Heading heading(const Sum& sum) const {
    if (!filter_.has_heading()) return {};
    const Turn ahead = between(marks_.followed, sum.position(axis_));
    return {.angle = core::rad(filter_.heading_rad(ahead)),
            .sigma = core::rad(core::square_root(filter_.heading_variance_rad2(ahead)))};
  }

  /// A sample of the vertical axis, as it is summed.
  constexpr void add(float rate_rad_s, core::Duration since_last) {
    const float length_s = since_last.in_seconds();
    recent_.add(rate_rad_s * length_s, length_s);
  }
  /// The filter follows the sum.
  constexpr void follow(const Sum& sum, float bias_variance_rad2_s2) {
    const Position now = sum.position(axis_);
    if (now.length_s == marks_.followed.length_s) return;
    filter_.advance(between(marks_.followed, now),
                    std::max(now.variance_rad2 - marks_.followed.variance_rad2, 0.0F),
                    bias_variance_rad2_s2);
    marks_.followed = now;
  }
  /// The vehicle moves after a stop that was learnt from: the sum is about to begin anew.
  /// @param temperature_k of the sensor; 0: not known
  constexpr void depart(const Sum& sum, core::Instant at, float bias_variance_rad2_s2,
                        float temperature_k) {
    follow(sum, bias_variance_rad2_s2);
    filter_.depart(bias_variance_rad2_s2, temperature_k);
    marks_ = {.departed = at, .rested = marks_.stopped, .stopped = marks_.stopped};
  }
  /// Goes on, before the first sample, with what another run has learnt.
  constexpr void resume(const core::LearntMotion& learnt, float pause_s) {
    filter_.resume(learnt, pause_s);
  }
  constexpr void stop(core::Instant at) { marks_.stopped = at; }
  /// The turn is not known any more.
  constexpr void lose() {
    filter_.lose_heading();
    marks_ = {.followed = marks_.followed};
  }

  /// @param newest time of the newest sample
  /// @return what became of it; where it was learnt, the sum is corrected
  constexpr Verdict take(const HeadingReference& reference, core::Instant newest, Sum& sum) {
    const auto position = recent_position(reference.time, newest, sum);
    if (!position) return Verdict::bad_time;
    return correcting(sum, [&] {
      return filter_.take_heading(reference.heading.in(core::rad),
                                  variance_of(reference.sigma, sum),
                                  between(marks_.followed, *position));
    });
  }
  constexpr Verdict take(const TurnReference& reference, core::Instant newest, Sum& sum) {
    if (!sum.is_known(axis_)) return Verdict::no_bias;
    const auto from = position_of_end(reference.from, newest, sum);
    const auto to = position_of_end(reference.to, newest, sum);
    if (!from || !to || reference.to <= reference.from) return Verdict::bad_time;
    const Verdict verdict = correcting(sum, [&] {
      return filter_.take_turn(reference.angle.in(core::rad), variance_of(reference.sigma, sum),
                               between(*from, *to),
                               std::max(to->variance_rad2 - from->variance_rad2, 0.0F));
    });
    marks_.turn_end = *to;
    marks_.turn_ended = reference.to;
    return verdict;
  }

 private:
  using Turn = core::HeadingFilter::Turn;

  static constexpr core::Instant kNever = core::kLatestTime;

  /// Sum of the stated variance and of that by the clock, which errs by a tenth of a second. The
  /// heading of a vehicle errs by a tenth of a degree at least.
  [[nodiscard]] constexpr float variance_of(core::Angle sigma, const Sum& sum) const {
    constexpr float kSmallest_rad = 0.1F * core::kRadPerDeg;
    constexpr float kClockSigma_s = 0.1F;
    const float late = sum.moves() ? sum.state().newest_rad_s[axis_] * kClockSigma_s : 0.0F;
    const float stated = std::max(sigma.in(core::rad), kSmallest_rad);
    return stated * stated + late * late;
  }
  /// Turn about the vertical between two positions of the sum.
  [[nodiscard]] constexpr Turn between(const Position& from, const Position& to) const {
    return {sense_ * to.turn_since(from), to.length_s - from.length_s};
  }
  /// Position at a time of the newest two seconds, or of the stop that lasts.
  [[nodiscard]] constexpr std::optional<Position> recent_position(core::Instant at,
                                                                  core::Instant newest,
                                                                  const Sum& sum) const {
    if (at > newest) return std::nullopt;
    Position position = sum.position(axis_);
    if (!sum.moves() && at >= marks_.stopped) return position;
    const float turn_rad = recent_.since(newest - at);
    if (!core::is_finite(turn_rad)) return std::nullopt;
    position.rest_rad -= turn_rad;
    if (sum.moves()) {
      position.length_s = std::max(position.length_s - (newest - at).in_seconds(), 0.0F);
    }
    return position;
  }
  [[nodiscard]] constexpr std::optional<Position> position_of_end(core::Instant at,
                                                                  core::Instant newest,
                                                                  const Sum& sum) const {
    if (at == marks_.turn_ended) return marks_.turn_end;
    if (marks_.rested <= at && at <= marks_.departed && marks_.departed != kNever) {
      return Position{};
    }
    return recent_position(at, newest, sum);
  }
  /// Does it, and takes what is known then of the offset off the turn that is summed already.
  template <class Take>
  constexpr Verdict correcting(Sum& sum, Take take) {
    const float before_rad_s = filter_.offset_rad_s();
    const Verdict verdict = take();
    const float change_rad_s = sense_ * (filter_.offset_rad_s() - before_rad_s);
    const float correction_rad = change_rad_s * sum.position(axis_).length_s;
    sum.correct(axis_, correction_rad);
    marks_.followed.sum_rad -= correction_rad;
    marks_.turn_end.sum_rad -= correction_rad;
    return verdict;
  }

  core::HeadingFilter filter_;
  core::RecentTurn recent_;
  Marks marks_{};
  float sense_;
  std::uint8_t axis_;
};

}  // namespace zerorate::app
