#include "firmware/boards/linux/outputs/json_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "core/base/numeric.hpp"
#include "firmware/wire/explained_shares.hpp"
#include "firmware/wire/health_bits.hpp"

namespace zerorate::linux_node {
namespace {

/// Appends to the buffer; JsonBuffer is longer than the longest line (see the test).
class Line {
 public:
  explicit Line(JsonBuffer& buffer) : buffer_(buffer) {}

  template <class... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    const auto added = fmt::format_to_n(buffer_.data() + used_, buffer_.size() - used_, format,
                                        std::forward<Arguments>(arguments)...);
    used_ = std::min(used_ + added.size, buffer_.size());
  }

  void add_rates(std::string_view name, const app::RateMessage& message,
                 core::AngularRate app::AxisRate::*member, bool is_known) {
    add_list(name, message.axes, [&](const app::AxisRate& axis) {
      return is_known ? (axis.*member).in(core::deg_per_s) : kUnknown;
    });
  }

  void add_turn(const app::RateMessage& message) {
    add_angles("turn_deg", message, &app::AxisTurn::angle);
    add_angles("turn_sigma_deg", message, &app::AxisTurn::sigma);
    add(",\"turn_s\":{}", message.turn_time.in_seconds());
  }

  void add_vertical(const app::RateMessage& message) {
    add_list("up", message.up, [](float share) { return share; });
    const bool has_rate = message.up && message.has_rate();
    add_number("vertical_rate_dps", has_rate,
               has_rate ? message.vertical_rate().in(core::deg_per_s) : 0.0F);
    add_number("slope_deg", message.slope.has_value(),
               message.slope.value_or(core::Angle{}).in(core::deg));
    const float turn_sigma_deg = message.vertical_turn.sigma.in(core::deg);
    const bool has_turn = message.up && core::is_finite(turn_sigma_deg);
    add_number("vertical_turn_deg", has_turn, message.vertical_turn.angle.in(core::deg));
    add_number("vertical_turn_sigma_deg", has_turn, turn_sigma_deg);
    const float sigma_deg = message.heading.sigma.in(core::deg);
    const bool is_known = core::is_finite(sigma_deg);
    add_number("heading_deg", is_known, message.heading.angle.in(core::deg));
    add_number("heading_sigma_deg", is_known, sigma_deg);
  }

  void add_inputs(const app::RateMessage& message) {
    add_number("temperature_c", message.temperature.has_value(),
               message.temperature.value_or(core::Temperature{}).degc());
    if (message.odometer_pulses) {
      add(",\"odometer_pulses\":{}", *message.odometer_pulses);
    } else {
      add(",\"odometer_pulses\":null");
    }
    add_list("acceleration_mps2", message.acceleration,
             [](core::Acceleration force) { return force.in(core::m_per_s2); });
    add_number("vibration_mps2", message.vibration.has_value(),
               message.vibration.value_or(core::Acceleration{}).in(core::m_per_s2));
  }

  void add_explained(const app::RateMessage& message) {
    for (const wire::ExplainedShare& share : wire::kExplainedShares) {
      add_list(share.name, message.explained, [&](const app::ExplainedBias& axis) {
        return (axis.*share.rate).in(core::deg_per_s);
      });
    }
  }

  void add_learnt(const wire::LearntModel& learnt) {
    add(",\"learnt\":{{\"stops\":{}", learnt.stops());
    for (const wire::LearntQuantity& quantity : wire::kLearntQuantities) {
      add_figures(quantity.name, learnt, quantity, &app::LearntFigure::value);
      add_figures(quantity.sigma_name, learnt, quantity, &app::LearntFigure::sigma);
    }
    add("}}");
  }

  [[nodiscard]] std::string_view text() const { return {buffer_.data(), used_}; }

 private:
  static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

  /// figure(element) of each of three elements; null where it is not finite.
  template <class Element, class Figure>
  void add_list(std::string_view name, const std::array<Element, 3>& elements, Figure figure) {
    add(",\"{}\":", name);
    char separator = '[';
    for (const Element& element : elements) {
      if (const float value = figure(element); core::is_finite(value)) {
        add("{}{}", separator, value);
      } else {
        add("{}null", separator);
      }
      separator = ',';
    }
    add("]");
  }
  /// Null where there are none.
  template <class Element, class Figure>
  void add_list(std::string_view name, const std::optional<std::array<Element, 3>>& elements,
                Figure figure) {
    if (elements) {
      add_list(name, *elements, figure);
    } else {
      add(",\"{}\":null", name);
    }
  }
  void add_number(std::string_view name, bool is_known, float number) {
    if (is_known && core::is_finite(number)) {
      add(",\"{}\":{}", name, number);
    } else {
      add(",\"{}\":null", name);
    }
  }
  void add_angles(std::string_view name, const app::RateMessage& message,
                  core::Angle app::AxisTurn::*member) {
    add_list(name, message.turn, [&](const app::AxisTurn& turn) {
      return core::is_finite(turn.sigma.in(core::deg)) ? (turn.*member).in(core::deg) : kUnknown;
    });
  }
  void add_figures(std::string_view name, const wire::LearntModel& learnt,
                   const wire::LearntQuantity& quantity, float app::LearntFigure::*member) {
    add_list(name, learnt.axes, [&](const app::LearntNoise& axis) {
      return axis.*quantity.figure.*member / quantity.si_per_unit;
    });
  }

  JsonBuffer& buffer_;
  std::size_t used_ = 0;
};

}  // namespace

std::string_view format_json_line(const wire::NumberedMessage& numbered, JsonBuffer& buffer,
                                  std::string_view node, const wire::LearntModel* learnt) {
  const app::RateMessage& message = numbered.message;
  Line line(buffer);
  line.add("{{");
  if (!node.empty()) line.add("\"node\":\"{}\",", node);
  line.add("\"sequence\":{},\"time_ns\":{},\"motion\":\"{}\"", numbered.sequence, message.time.ns(),
           core::name(message.motion));
  line.add_rates("rate_dps", message, &app::AxisRate::corrected, message.has_rate());
  line.add_rates("measured_dps", message, &app::AxisRate::measured, message.has_rate());
  line.add_rates("bias_dps", message, &app::AxisRate::bias, true);
  line.add_rates("sigma_dps", message, &app::AxisRate::sigma, true);
  line.add_turn(message);
  line.add_vertical(message);
  if (message.calm_percent == app::RateMessage::kNoCalm) {
    line.add(",\"calm_percent\":null");
  } else {
    line.add(",\"calm_percent\":{}", message.calm_percent);
  }
  line.add_inputs(message);
  line.add_explained(message);
  for (const wire::HealthBit& bit : wire::kHealthBits) {
    line.add(",\"{}\":{}", bit.name, message.health.*bit.flag);
  }
  if (learnt != nullptr) line.add_learnt(*learnt);
  line.add("}}\n");
  return line.text();
}

}  // namespace zerorate::linux_node
