#include "host_tools/lib/live/json_message.hpp"

#include <array>
#include <limits>
#include <nlohmann/json.hpp>

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

}  // namespace

std::optional<wire::NumberedMessage> parse_json_message(std::string_view line) {
  try {
    return read_message(json::parse(line));
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

}  // namespace zerorate::live
