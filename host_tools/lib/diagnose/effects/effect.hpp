/// @file
/// An effect of the catalogue: how it is searched for, and what is said of it once it is found.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/result/diagnosis.hpp"

namespace zerorate::diagnose {

/// The best that an effect can do for a hypothesis that does without it.
struct Offer {
  Part part;
  double gain_nats = 0.0;
  /// -log of the probability of so large a gain by chance, search included.
  double surprise_nats = 0.0;
};

/// A part of a hypothesis, for those who tell of it.
struct Found {
  const Explanation& all;
  std::size_t index = 0;  ///< of the part

  [[nodiscard]] const Part& part() const { return all.parts()[index]; }
  [[nodiscard]] double amplitude(std::size_t i) const;
  [[nodiscard]] double amplitude_error(std::size_t i) const;
};

/// What is said of an effect.
struct Account {
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

  [[nodiscard]] virtual std::string_view name() const = 0;
  /// What causes it was measured beside the rate.
  [[nodiscard]] virtual bool is_measured() const { return false; }
  /// Searches. Nothing where the record cannot show the effect or nothing at all is found.
  [[nodiscard]] virtual std::optional<Offer> examine(const Explanation& without) const = 0;
  [[nodiscard]] virtual Account tell(const Found& found) const = 0;
  /// Puts the effect into the model that the node runs.
  virtual void extend(const Found& found, model::SensorModel& model) const = 0;
};

}  // namespace zerorate::diagnose
