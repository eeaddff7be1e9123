#include "host_tools/lib/evaluate/learnt_model_json.hpp"

#include <nlohmann/json.hpp>
#include <string>

#include "host_tools/lib/recording/json.hpp"

namespace zerorate::evaluate {

nlohmann::ordered_json learnt_json(const LearntModel& learnt) {
  using recording::number;
  nlohmann::ordered_json json{{"stops", number(learnt.stops)}};
  const auto add = [&](const std::string& key, const LearntInterval& figure) {
    json[key] = number(figure.value);
    json[key + "_ci95"] = {number(figure.lo), number(figure.hi)};
  };
  add("order", learnt.order);
  add("bias_instability_dph", learnt.bias_instability_dph);
  add("angle_random_walk_dps_per_sqrt_hz", learnt.angle_random_walk_dps_per_sqrt_hz);
  return json;
}

}  // namespace zerorate::evaluate
