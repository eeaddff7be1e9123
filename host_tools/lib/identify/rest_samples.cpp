#include "host_tools/lib/identify/rest_samples.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "host_tools/lib/identify/lost_samples.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/sigma_of_changes.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::identify {
namespace {

/// Takes in rows and forgets those that a later pulse shows to have belonged to a drive.
class RestFilter {
 public:
  RestFilter(const recording::Columns& columns, const RestOptions& options, RestSamples& samples)
      : columns_(columns), standstill_(options.standstill), samples_(samples) {
    if (options.has_no_odometer) columns_.odometer = columns_.still = false;
  }

  void take(const recording::Row& row) {
    ++samples_.rows;
    const core::Instant at = core::Instant::from_ns(row.time_ns);
    std::int64_t pulses = 0;
    if (has_motion_column()) {
      standstill_.start(at);
      pulses = pulses_in(row);
      take_pulses(pulses, at);
    }
    if (is_after_break(row, at)) {
      driven_ = true;
      paused_ = paused_ + (at - row_before_);
    }
    row_before_ = at;
    if (!is_usable(row, at)) {
      count_lost_rates(row);
      ++samples_.lost;
    } else if (has_motion_column() && !standstill_.is_settled(at)) {
      ++samples_.moving;
      driven_ = true;
      if (pulses != 0) take_levels_on_the_move(row);
    } else {
      if (driven_ && !samples_.time.empty()) samples_.after_drives.push_back(samples_.time.size());
      driven_ = false;
      if (!samples_.time.empty()) samples_.paused = samples_.paused + paused_;
      paused_ = {};
      samples_.time.push_back(at);
      samples_.rate_rad_s.push_back(row.rate_rad_s);
      if (columns_.temperature) samples_.temperature_degc.push_back(row.temperature_degc);
      if (columns_.acceleration) samples_.acceleration_m_s2.push_back(row.acceleration_m_s2);
    }
  }

 private:
  void take_levels_on_the_move(const recording::Row& row) {
    for (std::size_t i = 0; i < columns_.axis_count; ++i) {
      samples_.levels_on_the_move[i].take(row.rate_rad_s[i]);
    }
  }
  void count_lost_rates(const recording::Row& row) {
    for (std::size_t i = 0; i < columns_.axis_count; ++i) {
      if (!std::isfinite(row.rate_rad_s[i])) ++samples_.lost_rates[i];
    }
  }
  [[nodiscard]] bool has_motion_column() const { return columns_.odometer || columns_.still; }

  /// Whether the clock stepped or a long pause came before the row: what it shows begins anew.
  [[nodiscard]] bool is_after_break(const recording::Row& row, core::Instant at) const {
    constexpr core::Duration kLongPause = core::Duration::seconds(30);
    return row.findings.has(recording::Finding::clock_step) ||
           (row.findings.has(recording::Finding::gap) && at - row_before_ > kLongPause);
  }

  /// None at rest; a single one may be a creeping vehicle's, which the word of a column is not.
  std::int64_t pulses_in(const recording::Row& row) {
    if (!columns_.odometer) return row.still ? 0 : 2;
    const std::int64_t pulses = samples_.rows > 1 ? std::abs(row.odometer_pulses - pulses_) : 0;
    pulses_ = row.odometer_pulses;
    return pulses;
  }

  void take_pulses(std::int64_t pulses, core::Instant at) {
    if (pulses == 0) return;
    // Several pulses share the time since the row before: at one time they would be bounces.
    if (pulses > 1) standstill_.pulse(row_before_ + (at - row_before_) / 2);
    standstill_.pulse(at);
    while (!samples_.time.empty() && samples_.time.back() > standstill_.discard_after(at)) {
      samples_.time.pop_back();
      samples_.rate_rad_s.pop_back();
      if (columns_.temperature) samples_.temperature_degc.pop_back();
      if (columns_.acceleration) samples_.acceleration_m_s2.pop_back();
      ++samples_.moving;
      driven_ = true;
    }
    auto& after_drives = samples_.after_drives;
    while (!after_drives.empty() && after_drives.back() >= samples_.time.size()) {
      after_drives.pop_back();
    }
  }

  [[nodiscard]] bool is_usable(const recording::Row& row, core::Instant at) const {
    for (std::size_t i = 0; i < columns_.axis_count; ++i) {
      if (!std::isfinite(row.rate_rad_s[i])) return false;
    }
    return samples_.time.empty() || at > samples_.time.back();
  }

  recording::Columns columns_;
  core::Standstill standstill_;
  RestSamples& samples_;
  core::Instant row_before_;
  std::int64_t pulses_ = 0;  ///< pulses of the row before
  core::Duration paused_;    ///< since the newest sample at rest
  bool driven_ = false;      ///< since the newest sample at rest
};

/// Where the longest run lies in which next(i) follows i.
struct Run {
  std::size_t first = 0;
  std::size_t size = 0;
};

template <class Follows>
Run longest_run(std::size_t count, Follows follows) {
  Run longest;
  Run current;
  for (std::size_t i = 0; i < count; ++i) {
    if (current.size > 0 && !follows(i)) current = {i, 0};
    ++current.size;
    if (current.size > longest.size) longest = current;
  }
  return longest;
}

/// Samples from the first one on that lie far from those that follow the first 50.
std::size_t count_wild_start(const RestSamples& samples, std::size_t axis) {
  constexpr std::size_t kMost = 50;
  if (samples.time.size() < kMost + statistics::kBehindStart) return 0;
  std::vector<double> behind;
  for (std::size_t k = kMost; k < kMost + statistics::kBehindStart; ++k) {
    behind.push_back(double{samples.rate_rad_s[k][axis]});
  }
  const double limit = statistics::wild_distance(behind);
  if (!(limit > 0.0)) return 0;  // coarse and quiet: the noise is not known
  const double level = statistics::median_of(std::move(behind));
  std::size_t wild = 0;
  while (wild < kMost && std::abs(double{samples.rate_rad_s[wild][axis]} - level) > limit) ++wild;
  return wild < kMost ? wild : 0;
}

/// Rows from the first one on that are equal on all axes, in a recording whose rows differ.
std::size_t count_dead_start(const RestSamples& samples) {
  constexpr std::size_t kFewest = 20;
  constexpr std::size_t kJudged = 2'000;
  const auto& rates = samples.rate_rad_s;
  std::size_t dead = 1;
  while (dead < rates.size() && rates[dead] == rates.front()) ++dead;
  if (dead < kFewest || dead == rates.size()) return 0;
  const std::size_t behind = std::min(rates.size() - dead, kJudged);
  const Run longest =
      longest_run(behind, [&](std::size_t i) { return rates[dead + i] == rates[dead + i - 1]; });
  return dead > 4 * longest.size ? dead : 0;
}

/// Many gyros deliver samples without meaning after power-on, several in a row. One alone is left
/// to those who look for it.
void leave_out_wild_start(RestSamples& samples) {
  constexpr std::size_t kFewest = 2;
  std::size_t wild = count_dead_start(samples);
  for (std::size_t i = 0; i < samples.axis_count; ++i) {
    wild = std::max(wild, count_wild_start(samples, i));
  }
  if (wild < kFewest) return;
  const auto leave_out = [&](auto& values) {
    if (!values.empty()) {
      values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(wild));
    }
  };
  leave_out(samples.time);
  leave_out(samples.rate_rad_s);
  leave_out(samples.temperature_degc);
  leave_out(samples.acceleration_m_s2);
  std::erase_if(samples.after_drives, [&](std::size_t k) { return k <= wild; });
  for (std::size_t& k : samples.after_drives) k -= wild;
  samples.wild = wild;
}

/// End of a sentence about too short a rest; empty where motion took less than half of the rows.
std::string share_of_motion(const RestSamples& samples) {
  if (2 * samples.moving < samples.rows) return "";
  return fmt::format(". {} of {} rows were left out because the vehicle moved; {}", samples.moving,
                     samples.rows, kCalmForAnOdometer);
}

/// Throws recording::DataError where too little is left.
void require_samples(const RestSamples& samples) {
  if (const std::uint64_t used = samples.rows - samples.lost; 2 * used < samples.rows) {
    const auto* const worst = std::ranges::max_element(samples.lost_rates);
    const auto axis = static_cast<std::size_t>(worst - samples.lost_rates.begin());
    throw recording::DataError(fmt::format(
        "{} of {} rows have no rate on all axes, and axis {} has none in {}: too few are left. One "
        "of the other axes alone: --columns rate=NAME",
        samples.lost, samples.rows, samples.axis_name(axis), *worst));
  }
  if (samples.time.size() < 2) {
    throw recording::DataError("the recording has fewer than two usable samples at rest" +
                               share_of_motion(samples));
  }
}

}  // namespace

void require_besides_motion(const RestSamples& samples, std::size_t found, std::size_t needed,
                            std::string_view what) {
  const std::string reason = share_of_motion(samples);
  if (found >= needed || reason.empty()) return;
  throw recording::DataError(
      fmt::format("too short a rest: {} {}, and {} are needed{}", found, what, needed, reason));
}

RestSamples without(RestSamples rest, const std::vector<std::size_t>& indices) {
  if (indices.empty()) return rest;
  const auto is_left_out = [&](std::size_t k) { return std::ranges::binary_search(indices, k); };
  const auto leave_out = [&](auto& values) {
    if (values.empty()) return;
    std::size_t kept = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (!is_left_out(k)) values[kept++] = values[k];
    }
    values.resize(kept);
  };
  leave_out(rest.time);
  leave_out(rest.rate_rad_s);
  leave_out(rest.temperature_degc);
  leave_out(rest.acceleration_m_s2);
  for (std::size_t& k : rest.after_drives) {
    k -= static_cast<std::size_t>(std::ranges::lower_bound(indices, k) - indices.begin());
  }
  std::erase_if(rest.after_drives, [&](std::size_t k) { return k >= rest.time.size(); });
  return rest;
}

/// The period of a sensor some of whose samples are lost is shorter than the mean interval of the
/// others.
void find_lost_samples(RestSamples& samples) {
  constexpr double kNoticed = 0.03;
  constexpr double kUncertain = 0.1;  // 5 % of N
  if (samples.is_timed_by_rows) return;
  const std::uint64_t spread = samples.findings.count(recording::Finding::time_spread);
  const LostShare lost = lost_share(samples.time, 2 * spread > samples.rows);
  if (lost.by_unevenness - lost.certain() > kUncertain) {
    throw recording::DataError(fmt::format(
        "the samples come as unevenly as if {:.0f} % of them were lost, and their stamps do not "
        "show which: N is not known. --rows-at HZ gives the rate of the sensor",
        100.0 * lost.by_unevenness));
  }
  if (lost.certain() < kNoticed) return;
  const auto mean_ns = static_cast<double>(lost.mean_interval.ns());
  const auto period = core::Duration::nanoseconds(std::llround(mean_ns * (1.0 - lost.certain())));
  samples.mean_period = std::min(samples.mean_period, period);
}

RestSamples read_rest_samples(recording::Reader& reader, const RestOptions& options) {
  constexpr std::uint64_t kProgressRows = 4096;
  RestSamples samples;
  samples.axis_count = reader.columns().axis_count;
  samples.is_timed_by_rows = reader.columns().is_timed_by_rows;
  RestFilter filter{reader.columns(), options, samples};
  for (recording::Row row; reader.next(row);) {
    filter.take(row);
    if (options.on_progress && samples.rows % kProgressRows == 0) {
      options.on_progress(reader.fraction_read());
    }
  }
  samples.findings = reader.findings();
  samples.sample_period = core::Duration::nanoseconds(samples.findings.median_interval_ns());
  samples.mean_period = core::Duration::nanoseconds(samples.findings.mean_interval_ns());
  leave_out_wild_start(samples);
  require_samples(samples);
  find_lost_samples(samples);
  return samples;
}

std::vector<TickMean> average_ticks(const RestSamples& samples, core::Duration tick) {
  core::TickAverage<recording::kMaxAxes> average{tick, samples.sample_period};
  std::vector<TickMean> means;
  for (std::size_t k = 0; k < samples.time.size(); ++k) {
    const core::Instant at = samples.time[k];
    if (!average.can_take(at)) throw recording::DataError("the recording exceeds 2^31 ticks");
    if (average.is_over_at(at) && !average.is_empty()) means.push_back(average.close());
    average.enter(at);
    average.add(at, samples.rate_rad_s[k]);
  }
  if (!average.is_empty()) means.push_back(average.close());
  return means;
}

EvenRecord longest_even_samples(const RestSamples& samples, std::size_t axis) {
  const std::int64_t period_ns = samples.sample_period.ns();
  const Run run = longest_run(samples.time.size(), [&](std::size_t i) {
    return std::abs((samples.time[i] - samples.time[i - 1]).ns() - period_ns) * 2 <= period_ns;
  });
  EvenRecord record{.sample_period_s = static_cast<double>(period_ns) * 1e-9};
  for (std::size_t i = run.first; i < run.first + run.size; ++i) {
    record.rate_rad_s.push_back(double{samples.rate_rad_s[i][axis]});
  }
  if (run.size > 1) {
    const auto whole = samples.time[run.first + run.size - 1] - samples.time[run.first];
    record.sample_period_s =
        static_cast<double>(whole.ns()) * 1e-9 / static_cast<double>(run.size - 1);
  }
  return record;
}

EvenRecord longest_even_ticks(const std::vector<TickMean>& ticks, core::Duration tick,
                              std::size_t axis) {
  const Run run = longest_run(
      ticks.size(), [&](std::size_t i) { return ticks[i].tick == ticks[i - 1].tick + 1; });
  EvenRecord record{.sample_period_s = static_cast<double>(tick.ns()) * 1e-9};
  for (std::size_t i = run.first; i < run.first + run.size; ++i) {
    record.rate_rad_s.push_back(double{ticks[i].rate_rad_s[axis]});
  }
  return record;
}

std::vector<std::size_t> axes_called(std::string_view name, std::size_t axis_count) {
  if (name == "all") {
    return axis_count == 1 ? std::vector<std::size_t>{0} : std::vector<std::size_t>{0, 1, 2};
  }
  if (name.size() != 1 || name[0] < 'x' || name[0] > 'z') {
    throw std::invalid_argument(fmt::format("axis: expected x, y, z or all, found {}", name));
  }
  const auto axis = static_cast<std::size_t>(name[0] - 'x');
  if (axis >= axis_count) {
    throw std::invalid_argument(fmt::format("axis {}: the recording has one axis; use all", name));
  }
  return {axis};
}

}  // namespace zerorate::identify
