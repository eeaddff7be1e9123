#include "host_tools/lib/recording/json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace zerorate::recording {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json to_json(const Findings& findings) {
  Json json = Json::object();
  for (std::size_t i = 0; i < kFindingCount; ++i) {
    const auto finding = static_cast<Finding>(i);
    if (findings.count(finding) == 0) continue;
    json[std::string(description(finding))] = {{"rows", findings.count(finding)},
                                               {"first_line", findings.first_line(finding)}};
  }
  return json;
}

}  // namespace zerorate::recording
