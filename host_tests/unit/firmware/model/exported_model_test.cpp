// The way of every field of a model file to the node: a field that is forgotten on it fails here.
#include <full_model.h>
#include <gtest/gtest.h>
#include <full_model_params.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/c_api/model_checks.hpp"
#include "firmware/c_api/node_of_model.hpp"
#include "firmware/model/model_fields.hpp"
#include "firmware/model/node_model.hpp"
#include "firmware/model/source_headers.hpp"
#include "host_tests/unit/firmware/model/full_model.hpp"

namespace zerorate::model {
namespace {

/// A visitor of model_fields.hpp that changes one field of those that a node computes with.
class Change {
 public:
  explicit Change(int which) : left_(which) {}

  void number(std::string_view key, double& si, FileUnit /*unit*/, const Rule& /*rule*/,
              Presence /*presence*/) {
    if (is_turn_of(key)) si *= 1.1;
  }
  void number(std::string_view key, int& value, FileUnit /*unit*/, const Rule& rule,
              Presence /*presence*/) {
    if (is_turn_of(key)) value = rule.holds(value + 1) ? value + 1 : value / 3;
  }
  void axes(std::string_view key, std::array<double, 3>& si, FileUnit unit, const Rule& rule) {
    for (double& one : si) number(key, one, unit, rule, Presence::optional);
  }
  void bias_instability(double& si, const Rule& rule) {
    number("bias_instability", si, FileUnit::si, rule, Presence::required);
  }
  template <class Enumeration>
  void name(std::string_view key, Enumeration& value, std::span<const std::string_view> names) {
    if (!is_turn_of(key)) return;
    value = static_cast<Enumeration>((static_cast<std::size_t>(value) + 1) % names.size());
  }
  void text(std::string_view /*key*/, std::string& /*value*/, Presence /*presence*/) {}

  template <class Part>
  void table(std::string_view key, Part& part, Presence /*presence*/) {
    table_ = key;
    visit_fields(*this, part);
  }
  template <class Part>
  void table(std::string_view key, std::optional<Part>& part) {
    EXPECT_TRUE(part.has_value()) << "the full model has no table " << key;
    if (part) table(key, *part, Presence::required);
  }
  template <class Part>
  void tables(std::string_view key, std::vector<Part>& parts) {
    EXPECT_FALSE(parts.empty()) << "the full model has no table " << key;
    for (Part& part : parts) table(key, part, Presence::required);
  }

  /// Name of the field; empty: there are fewer fields.
  [[nodiscard]] const std::string& changed() const { return changed_; }

 private:
  bool is_turn_of(std::string_view key) {
    if (left_-- != 0) return false;
    changed_ = table_ + "." + std::string{key};
    return true;
  }

  int left_;
  std::string table_;
  std::string changed_;
};

/// Fields whose change does not change what `format` makes of a model.
template <class Format>
std::string forgotten_fields(Format format) {
  const std::string before = format(full_model());
  std::string forgotten;
  for (int which = 0;; ++which) {
    SensorModel model = full_model();
    Change change{which};
    visit_fields(change, model);
    if (change.changed().empty()) return forgotten;
    if (format(model) == before) forgotten += change.changed() + " ";
  }
}

TEST(CppHeader, ChangesWithEveryFieldOfTheModel) {
  EXPECT_EQ(forgotten_fields([](const SensorModel& model) {
              return format_cpp_header(model, kFullPeriod, kFullTick) +
                     format_cpp_header(without_accelerometer(model), kFullPeriod, kFullTick);
            }),
            "");
}

TEST(CHeader, ChangesWithEveryFieldButThoseOfSingleSamples) {
  EXPECT_EQ(forgotten_fields([](const SensorModel& model) {
              const SensorModel in_c = full_model_for_c(model);
              return format_c_header(in_c, kFullPeriod, kFullTick, "full_model") +
                     format_c_header(without_accelerometer(in_c), kFullPeriod, kFullTick, "blind");
            }),
            "outliers.probability outliers.sigma_dps motion_contamination.interval_s "
            "motion_contamination.duration_s motion_contamination.sigma_dps "
            "variable_noise.variance_sigma variable_noise.time_constant_s saturation.lower_dps "
            "saturation.upper_dps ");
}

TEST(CppHeaderCompiled, HoldsTheBitsOfTheModel) {
  EXPECT_TRUE(exported::kNodeParams.model ==
              make_node_model<exported::kModelShape>(full_model(), kFullPeriod, kFullTick));
}

TEST(CHeaderCompiled, GivesANodeTheBitsOfTheModel) {
  const auto node = make_node_model<c_api::kShape>(full_model_for_c(), kFullPeriod, kFullTick);
  EXPECT_TRUE(c_api::params_of(::full_model, zerorate_config{}).model == node);
}

/// Bytes of the C structure that are no float.
bool is_other(std::size_t at) {
  return at < offsetof(zerorate_model, walk_variance_rad2_s2) ||
         at == offsetof(zerorate_model, gate_longest_knock_ticks) ||
         at == offsetof(zerorate_model, hypothesis_count) ||
         at == offsetof(zerorate_model, inputs) ||
         at == offsetof(zerorate_model, inputs) + sizeof(zerorate_input) ||
         at >= offsetof(zerorate_model, hypotheses) + sizeof(zerorate_model::hypotheses);
}

TEST(CStructure, IsRefusedWithNoNumberInAnyFloat) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  zerorate_model sound = ::full_model;
  sound.decaying[ZERORATE_DECAYING_MODES - 1] = sound.decaying[0];  // no mode without effect
  ASSERT_TRUE(c_api::is_sound(sound));
  for (std::size_t at = 0; at < sizeof(zerorate_model); at += sizeof(float)) {
    if (is_other(at)) continue;
    zerorate_model model = sound;
    std::memcpy(reinterpret_cast<char*>(&model) + at, &kNan, sizeof kNan);
    EXPECT_FALSE(c_api::is_sound(model)) << "the float at byte " << at;
  }
}

}  // namespace
}  // namespace zerorate::model
