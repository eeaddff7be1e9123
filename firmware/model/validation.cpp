#include "firmware/model/sensor_model.hpp"

#include <array>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/model_fields.hpp"

namespace zerorate::model {
namespace {

/// A visitor of model_fields.hpp that throws at the first number that breaks its rule.
class Validator {
 public:
  explicit Validator(std::string_view prefix) : prefix_(prefix) {}

  void number(std::string_view key, double si, FileUnit unit, const Rule& rule,
              Presence /*presence*/) {
    const double value = in_unit(si, unit);
    if (!rule.holds(value)) {
      std::ostringstream message;
      message << prefix_ << key << " is " << value << "; expected " << rule.words;
      throw std::invalid_argument(message.str());
    }
  }
  void axes(std::string_view key, const std::array<double, 3>& si, FileUnit unit,
            const Rule& rule) {
    for (const double one : si) number(key, one, unit, rule, Presence::optional);
  }
  void bias_instability(double si, const Rule& rule) {
    number("bias_instability_dph", si, FileUnit::degree_per_hour, rule, Presence::required);
  }
  void text(std::string_view /*key*/, const std::string& /*value*/, Presence /*presence*/) {}
  template <class Enumeration>
  void name(std::string_view /*key*/, Enumeration /*value*/,
            std::span<const std::string_view> /*names*/) {}

  template <class Part>
  void table(std::string_view key, const Part& part, Presence /*presence*/) {
    Validator inside(std::string(key) + '.');
    visit_fields(inside, part);
  }
  template <class Part>
  void table(std::string_view key, const std::optional<Part>& part) {
    if (part) {
      table(key, *part, Presence::required);
    }
  }
  template <class Part>
  void tables(std::string_view key, const std::vector<Part>& parts) {
    for (const Part& part : parts) {
      table(key, part, Presence::required);
    }
  }

 private:
  std::string prefix_;
};

}  // namespace

void validate(const SensorModel& model) {
  Validator validator("");
  visit_fields(validator, model);
}

void validate(const Flicker& flicker) {
  Validator validator("flicker.");
  visit_fields(validator, flicker);
}

}  // namespace zerorate::model
