/// @file
/// One blind recording: what is hidden in it, drawn from a seed, and the file that tells nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_tools/lib/simulate/effects/signal.hpp"
#include "host_tools/lib/simulate/scenario.hpp"
#include "host_tools/lib/simulate/sizing/sized_effect.hpp"

namespace zerorate::campaign {

enum class Kind : std::uint8_t { clean, single, pair, outside };
[[nodiscard]] std::string_view name(Kind kind);

struct BlindRecording {
  Kind kind = Kind::clean;
  std::vector<std::string> truth;  ///< names of what is hidden, none if clean
  std::map<std::string, std::map<std::string, double>> figures;  ///< effect, figure
  std::string description;          ///< sample rate, noise and sizes, for who reads of a miss
  bool with_temperature = false;    ///< whether the recording has the column
  std::vector<std::string> also{};  ///< effects that come with them, and need not be named
  std::vector<std::array<float, 3>> acceleration_m_s2{};  ///< one a sample, or none
  std::vector<bool> still{};                              ///< likewise
  simulate::Signal signal;
  std::optional<simulate::ScenarioDrive> drive{};  ///< in place of the signal
};

struct BlindOptions {
  std::uint64_t seed = 1;
  std::size_t samples = 20'000;
  double rate_hz = 0.0;  ///< rate of the samples; 0: drawn for each recording
  double nats = 40.0;    ///< loss of the best base model to each effect
  /// Factor by which effects outside the catalogue are larger: the remainder must fail a test that
  /// holds against the whole family of statistics.
  double outside_factor = 2.5;
  /// Name of the only effect of single recordings to draw; all if empty.
  std::string only;
  bool standstills = false;  ///< recordings of several standstills, see standstill_recording.hpp
  bool drives = false;       ///< hours of drives with a reference, see drive_recording.hpp
  double finest_step_share =
      0.1;  ///< see RecordingSetting; 1: a quantizer costs the nats as all others do
};

/// Recordings of each kind in a round, in the order in which they are drawn. Singles hide each
/// effect of the catalogue once.
struct Round {
  static constexpr std::size_t kSingles = sizing::kKnownEffects;
  static constexpr std::size_t kClean = 8;
  static constexpr std::size_t kPairs = 4;
  static constexpr std::size_t kOutside = 4;
  static constexpr std::size_t kRuns = kSingles + kClean + kPairs + kOutside;
};
[[nodiscard]] Kind kind_of_run(std::size_t run);

/// A pure function of the options and the number of the run.
[[nodiscard]] BlindRecording draw_blind_recording(const BlindOptions& options, std::size_t run);

/// Writes the rows of the drive, or of the signal: time and rate; temperature, accelerations and
/// standstills if the recording has them.
void write_recording(const BlindRecording& blind, const std::filesystem::path& path);

void write_drive(const simulate::ScenarioDrive& drive, const std::filesystem::path& path);

}  // namespace zerorate::campaign
