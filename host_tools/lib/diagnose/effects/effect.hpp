/// @file
/// An effect of the catalogue: how it is searched for, described and added to a model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// Best part that an effect can add to a hypothesis without it.
struct Candidate {
  Part part;
  double gain_nats = 0.0;
  /// Surprisal of the gain: -log of the probability of so large a gain by chance, search included.
  double surprisal_nats = 0.0;
  NoiseSpectrum noise{};      ///< fitted with the part, where only terms of the noise were
  double time_scale_s = 0.0;  ///< duration of the change, for an effect of either pace
};

/// Pace of an effect: the scale at which a record shows it.
enum class Pace : std::uint8_t {
  fast,    ///< in single values, or in noise between neighbours
  slow,    ///< in means over many values as well as in the values
  either,  ///< time scale of the candidate decides
};

/// A fitted part together with the hypothesis that contains it.
struct FittedPart {
  const Hypothesis& hypothesis;
  std::size_t index = 0;  ///< place of the part

  [[nodiscard]] const Part& part() const { return hypothesis.parts()[index]; }
  /// Amplitude of column `i` of the part, and its standard error [rad/s per unit of the column].
  [[nodiscard]] double amplitude(std::size_t i) const;
  [[nodiscard]] double amplitude_error(std::size_t i) const;
};

/// Obstacle of effects on single samples: means over ticks were tested, not samples.
inline constexpr std::string_view kUnevenSamples = "samples too uneven";

/// Words and figures of a fitted effect.
struct Description {
  std::vector<Parameter> parameters;
  std::string sentence;
  Drawing drawing;
};

class Effect {
 public:
  Effect() = default;
  Effect(const Effect&) = delete;
  Effect& operator=(const Effect&) = delete;
  virtual ~Effect() = default;

  /// Name in the catalogue, e.g. "rate_random_walk".
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// True if the record contains the quantity that causes the effect (e.g. the temperature).
  [[nodiscard]] virtual bool has_measured_cause() const { return false; }
  /// True if the effect is a term of the noise's spectrum and nothing else.
  [[nodiscard]] virtual bool is_noise() const { return false; }
  [[nodiscard]] virtual Pace pace() const { return Pace::fast; }
  /// Reason why a record cannot show the effect, e.g. "no temperature"; empty if it can.
  [[nodiscard]] virtual std::string_view obstacle(const Hypothesis& /*without*/) const {
    return {};
  }
  /// Searches for the effect; nothing where it is not found or where there is an obstacle.
  /// @param without  hypothesis without the effect
  [[nodiscard]] std::optional<Candidate> examine(const Hypothesis& without) const;
  /// True if the node needs no extension for it: white and flicker noise of tick means contain it.
  [[nodiscard]] virtual bool is_in_base() const { return false; }
  [[nodiscard]] virtual Description describe(const FittedPart& fitted) const = 0;
  /// Adds the effect to the model that the node runs.
  virtual void add_to_model(const FittedPart& fitted, model::SensorModel& model) const = 0;

 private:
  /// Searches where there is no obstacle.
  [[nodiscard]] virtual std::optional<Candidate> find(const Hypothesis& without) const = 0;
};

}  // namespace zerorate::diagnose
