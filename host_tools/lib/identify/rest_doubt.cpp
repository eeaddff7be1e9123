#include "host_tools/lib/identify/rest_doubt.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "host_tools/lib/recording/error.hpp"

namespace zerorate::identify {
namespace {

constexpr std::array kDoubts{doubt::kCounts, doubt::kUnit,      doubt::kMotion, doubt::kAngles,
                             doubt::kPeriod, doubt::kSensors,   doubt::kFrozen, doubt::kCopies,
                             doubt::kBias,   doubt::kTruncation};

}  // namespace

std::string doubt_names() {
  return fmt::format("{}", fmt::join(kDoubts, ", "));
}

AcceptedDoubts::AcceptedDoubts(std::string_view names) {
  while (!names.empty()) {
    const std::string_view name = names.substr(0, names.find(','));
    names.remove_prefix(std::min(name.size() + 1, names.size()));
    const auto* const doubt = std::ranges::find(kDoubts, name);
    if (doubt == kDoubts.end()) {
      throw std::invalid_argument(
          fmt::format("no doubt \"{}\" that could be accepted; there are {}", name, doubt_names()));
    }
    names_.push_back(*doubt);
  }
}

bool AcceptedDoubts::has(std::string_view name) const {
  return std::ranges::find(names_, name) != names_.end();
}

std::vector<std::string> require_rest(const std::vector<RestDoubt>& doubts,
                                      const AcceptedDoubts& accepted,
                                      std::vector<std::size_t>& axes) {
  std::vector<std::string> remarks;
  for (const RestDoubt& doubt : doubts) {
    const bool is_of_others = doubt.axis && std::ranges::find(axes, *doubt.axis) == axes.end();
    if (is_of_others || accepted.has(doubt.name)) continue;
    std::string sentence =
        fmt::format("{}. If it is right as it is: --accept {}", doubt.sentence, doubt.name);
    if (doubt.is_certain) {
      if (!doubt.axis || axes.size() == 1) throw recording::DataError(sentence);
      std::erase(axes, *doubt.axis);
    }
    remarks.push_back(std::move(sentence));
  }
  return remarks;
}

}  // namespace zerorate::identify
