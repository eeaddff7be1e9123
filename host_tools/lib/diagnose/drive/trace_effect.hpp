/// @file
/// Effects that show in the rows and in the reference of single drives, not in a sum over many.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/diagnose/drive/trace.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// Surprisal of what the rows show without any doubt, such as a gap.
inline constexpr double kPlain_nats = 40.0;

/// An effect as it was found.
struct TraceFinding {
  std::string effect;
  std::vector<std::size_t> drives;  ///< numbers of those it spoils, which make no cause
  double surprisal_nats = kPlain_nats;
  std::vector<Parameter> parameters;
  std::string sentence;
  std::string left_out_because;  ///< reason why no model can have it
  double delay_s = 0.0;          ///< delay of the reference; 0 for any other fault
};

class TraceEffect {
 public:
  TraceEffect() = default;
  TraceEffect(const TraceEffect&) = delete;
  TraceEffect& operator=(const TraceEffect&) = delete;
  TraceEffect(TraceEffect&&) = delete;
  TraceEffect& operator=(TraceEffect&&) = delete;
  virtual ~TraceEffect() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual std::optional<TraceFinding> find(const Trace& trace) const = 0;
};

[[nodiscard]] std::unique_ptr<TraceEffect> make_reference_delay();
[[nodiscard]] std::unique_ptr<TraceEffect> make_reference_fault();
[[nodiscard]] std::unique_ptr<TraceEffect> make_gap_in_turn();
[[nodiscard]] std::unique_ptr<TraceEffect> make_saturation_in_turn();

/// The delay of the reference, whatever its size [s]; 0 where it cannot be told.
[[nodiscard]] double delay_of_reference(const Trace& trace);

/// All that are found. The delay of the reference is taken off the trace first.
[[nodiscard]] std::vector<TraceFinding> find_in_trace(Trace trace);

/// The times of departure of drives as text, the first few of many.
[[nodiscard]] std::string departures(const Trace& trace, const std::vector<std::size_t>& drives);

/// A parameter that was counted or summed, without an error.
[[nodiscard]] Parameter exact(std::string name, double value);

}  // namespace zerorate::diagnose
