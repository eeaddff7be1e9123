#include "host_tools/lib/live/page/page_json.hpp"

#include "core/base/attitude.hpp"
#include "core/base/numeric.hpp"
#include "firmware/wire/explained_shares.hpp"
#include "firmware/wire/health_bits.hpp"
#include "host_tools/lib/live/view.hpp"
#include "host_tools/lib/statistics/half_width.hpp"

namespace zerorate::live {
namespace {

using nlohmann::json;

/// A rate in the unit; null where it is none.
json number(bool is_known, core::AngularRate rate, core::Unit<core::AngularRateDimension> unit) {
  const float figure = rate.in(unit);
  return is_known && core::is_finite(figure) ? json(figure) : json(nullptr);
}

json learnt_json(const wire::LearntModel& learnt) {
  json figures{{"stops", learnt.stops()}};
  for (const app::LearntNoise& axis : learnt.axes) {
    for (const wire::LearntQuantity& quantity : wire::kLearntQuantities) {
      const app::LearntFigure& figure = axis.*quantity.figure;
      figures[std::string{quantity.name}].push_back(figure.value / quantity.si_per_unit);
      figures[std::string{quantity.sigma_name}].push_back(figure.sigma / quantity.si_per_unit);
    }
  }
  return figures;
}

/// An angle with its 95 % interval; null where it is not known.
struct AngleJson {
  json deg;
  json half95_deg;
};
AngleJson angle_json(core::Angle angle, core::Angle sigma, bool is_heard) {
  const float sigma_deg = sigma.in(core::deg);
  if (!is_heard || !core::is_finite(sigma_deg)) return {};
  return {angle.in(core::deg), sigma_deg * static_cast<float>(statistics::kHalfWidth95)};
}

/// Rate and heading about the vertical; null where its axis is not given.
json vertical_json(const app::RateMessage& message, bool is_heard) {
  if (!message.up) return nullptr;
  const AngleJson heading = angle_json(message.heading.angle, message.heading.sigma, is_heard);
  return {{"rate_dps",
           number(is_heard && message.has_rate(), message.vertical_rate(), core::deg_per_s)},
          {"heading_deg", heading.deg},
          {"heading_half95_deg", heading.half95_deg}};
}

/// Attitude of the sensor; null where the direction that points up is not known.
json attitude_json(const app::RateMessage& message, bool is_heard) {
  if (!message.up || !is_heard) return nullptr;
  const core::Attitude attitude = core::attitude_of(*message.up);
  json slope = message.slope ? json(message.slope->in(core::deg)) : json{};
  return {{"tilt_deg", attitude.tilt.in(core::deg)},
          {"roll_deg", attitude.roll.in(core::deg)},
          {"pitch_deg", attitude.pitch.in(core::deg)},
          {"slope_deg", std::move(slope)}};
}

/// Shares of the bias by input, of x, y and z; null where the model has no inputs.
json explained_json(const app::RateMessage& message, bool is_heard) {
  if (!message.explained || !is_heard) return nullptr;
  json shares = json::array();
  for (const wire::ExplainedShare& share : wire::kExplainedShares) {
    json rates = json::array();
    for (const app::ExplainedBias& axis : *message.explained) {
      rates.push_back(number(true, axis.*share.rate, core::deg_per_s));
    }
    shares.push_back({{"input", share.input}, {"rate_dps", rates}});
  }
  return shares;
}

}  // namespace

json now_json(const Tally& tally, const std::string& source, std::chrono::milliseconds silence) {
  const bool is_heard = is_present(tally, silence);
  const app::RateMessage message = tally.newest ? tally.newest->message : app::RateMessage{};
  const bool is_calibrated = message.health.calibrated;
  json now{{"source", source},
           {"messages", tally.messages},
           {"lost", tally.lost},
           {"damaged", tally.damaged},
           {"restarts", tally.restarts},
           {"stops", tally.stops},
           {"motion", core::name(message.motion)},
           {"wrong", json::array()},
           {"axes", json::array()}};
  now["silent_s"] = is_heard ? json(nullptr) : json(silence.count() / 1000);
  now["calm_percent"] = message.calm_percent == app::RateMessage::kNoCalm
                            ? json(nullptr)
                            : json(message.calm_percent);
  for (const wire::HealthBit& bit : wire::kHealthBits) {
    const bool is_set = message.health.*bit.flag;
    const bool is_good = bit.flag == &app::Health::calibrated;
    if (is_set != is_good) now["wrong"].push_back(bit.name);
  }
  for (std::size_t i = 0; i < message.axes.size(); ++i) {
    const app::AxisRate& axis = message.axes.at(i);
    const app::AxisTurn& turn = message.turn.at(i);
    const AngleJson turned = angle_json(turn.angle, turn.sigma, is_heard);
    now["axes"].push_back(
        {{"rate_dps", number(is_heard && message.has_rate(), axis.corrected, core::deg_per_s)},
         {"bias_dps", number(is_calibrated, axis.bias, core::deg_per_s)},
         {"half95_dps",
          number(is_calibrated, axis.sigma * static_cast<float>(statistics::kHalfWidth95),
                 core::deg_per_s)},
         {"turn_deg", turned.deg},
         {"turn_half95_deg", turned.half95_deg}});
  }
  now["vertical"] = vertical_json(message, is_heard);
  now["attitude"] = attitude_json(message, is_heard);
  now["vibration_g"] = message.vibration && is_heard
                           ? json(message.vibration->in(core::standard_gravity))
                           : json(nullptr);
  now["explained"] = explained_json(message, is_heard);
  now["learnt"] =
      tally.learnt && tally.learnt->is_learnt() ? learnt_json(*tally.learnt) : json(nullptr);
  return now;
}

json point_json(const json& now) {
  const auto unix_time = std::chrono::system_clock::now().time_since_epoch();
  json point{std::chrono::duration<double>(unix_time).count()};
  const bool is_heard = now["silent_s"].is_null();
  for (const json& axis : now["axes"]) {
    for (const char* const figure : {"bias_dps", "half95_dps"}) {
      point.push_back(is_heard ? axis[figure] : json(nullptr));
    }
  }
  point.push_back(is_heard ? json(now["motion"] == core::name(core::Motion::still) ? 1 : 0)
                           : json(nullptr));
  return point;
}

}  // namespace zerorate::live
