#include "host_tools/lib/live/json_message.hpp"

#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/numeric.hpp"
#include "firmware/wire/health_bits.hpp"

namespace zerorate::live {
namespace {

using nlohmann::json;

void read_rates(const json& rates, app::RateMessage& message,
                core::AngularRate app::AxisRate::*member, float where_null_dps) {
  for (std::size_t i = 0; i < message.axes.size(); ++i) {
    const json& rate = rates.at(i);
    message.axes.at(i).*member =
        core::deg_per_s(rate.is_null() ? where_null_dps : rate.get<float>());
  }
}

core::Motion read_motion(const json& word) {
  for (const auto motion : {core::Motion::moving, core::Motion::settling, core::Motion::still}) {
    if (word == core::name(motion)) return motion;
  }
  throw json::other_error::create(501, "unknown motion", &word);
}

wire::NumberedMessage read_message(const json& line) {
  wire::NumberedMessage numbered{.sequence = line.at("sequence"), .message = {}};
  app::RateMessage& message = numbered.message;
  message.time = core::Instant::from_ns(line.at("time_ns"));
  message.motion = read_motion(line.at("motion"));
  read_rates(line.at("rate_dps"), message, &app::AxisRate::corrected, 0.0F);
  read_rates(line.at("measured_dps"), message, &app::AxisRate::measured, 0.0F);
  read_rates(line.at("bias_dps"), message, &app::AxisRate::bias, 0.0F);
  read_rates(line.at("sigma_dps"), message, &app::AxisRate::sigma,
             std::numeric_limits<float>::infinity());
  const json& calm = line.at("calm_percent");
  if (!calm.is_null()) message.calm_percent = calm;
  for (const wire::HealthBit& bit : wire::kHealthBits) {
    message.health.*bit.flag = line.at(std::string{bit.name});
  }
  return numbered;
}

/// A figure that no model can have is as wrong as one that is missing.
float read_figure(const json& number) {
  const auto figure = number.get<float>();
  if (!core::is_finite(figure) || figure < 0.0F) {
    throw json::other_error::create(502, "impossible figure", &number);
  }
  return figure;
}

wire::LearntModel read_learnt(const json& member) {
  wire::LearntModel learnt;
  for (std::size_t i = 0; i < learnt.axes.size(); ++i) {
    app::LearntNoise& axis = learnt.axes.at(i);
    axis.stops = read_figure(member.at("stops"));
    for (const wire::LearntQuantity& quantity : wire::kLearntQuantities) {
      const json& value = member.at(std::string{quantity.name}).at(i);
      const json& sigma = member.at(std::string{quantity.sigma_name}).at(i);
      axis.*quantity.figure = {.value = read_figure(value) * quantity.si_per_unit,
                               .sigma = read_figure(sigma) * quantity.si_per_unit};
    }
  }
  return learnt;
}

}  // namespace

std::optional<JsonMessage> parse_json_message(std::string_view line) {
  try {
    const json parsed = json::parse(line);
    JsonMessage read{.message = read_message(parsed), .learnt = {}};
    if (parsed.contains("learnt")) read.learnt = read_learnt(parsed.at("learnt"));
    return read;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

}  // namespace zerorate::live
