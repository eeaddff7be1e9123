/// @file
/// Recordings of a simulated fleet: a population of sensors, some with a hidden effect, one bad
/// lot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>

namespace zerorate::fleet {

/// Lognormal quantity: median and standard deviation of the natural logarithm.
struct Lognormal {
  double median = 1.0;
  double log_sigma = 0.0;
};

struct SimulatedFleetOptions {
  std::size_t sensors = 100;
  std::size_t recordings = 1;  ///< recordings of each sensor, at rest
  std::size_t samples = 20'000;
  double rate_hz = 20.0;
  std::size_t lots = 20;
  std::uint64_t seed = 1;
  Lognormal white_dps_per_sqrt_hz{0.005, 0.15};  ///< N
  Lognormal flicker_dph{12.0, 0.3};              ///< B, the root of the density at 1 rad/s
  Lognormal order{0.55, 0.1};                    ///< d, less than 0.95
  /// Share of the variance of the logarithms that the axes of a sensor have in common.
  double common_share = 0.5;
  double hidden_share = 0.03;  ///< share of the sensors with an effect of the catalogue on one axis
  double nats = 40.0;          ///< likelihood that the best base model loses to the effect
  double bad_lot_factor = 1.5;  ///< on N and B of the sensors of one lot; 1: none is bad
  unsigned jobs = 1;            ///< threads; 0: as many as the machine has
};

/// Writes the recordings as CSV.gz, the list kListName with sensor and lot, and `truth.csv` with
/// what each axis really has. A pure function of the options, whatever the number of threads.
/// @param on_progress  told the share that is written, 0 to 1
void simulate_fleet(const SimulatedFleetOptions& options, const std::filesystem::path& folder,
                    const std::function<void(double)>& on_progress);

}  // namespace zerorate::fleet
