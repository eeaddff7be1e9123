#include "host_tools/lib/simulate/simulate.hpp"

#include <map>
#include <utility>

namespace zerorate::simulate {

std::string_view name(const Effect& effect) {
  return std::visit([](const auto& part) { return part.kName; }, effect);
}

Signal simulate(Signal signal, std::span<const Effect> effects,
                const random::RandomStream& stream) {
  std::map<std::string_view, std::uint64_t> occurrences;
  for (const Effect& effect : effects) {
    const std::uint64_t occurrence = occurrences[name(effect)]++;
    const random::RandomStream own = stream.substream(name(effect)).substream(occurrence);
    std::visit([&](const auto& part) { part.apply(signal, own); }, effect);
  }
  return signal;
}

}  // namespace zerorate::simulate
