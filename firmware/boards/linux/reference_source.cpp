#include "firmware/boards/linux/reference_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace zerorate::linux_node {
namespace {

constexpr std::size_t kMostWords = 4;
constexpr double kWidest_deg = 90.0;
constexpr double kLongestTurn_s = 86'400.0;
constexpr double kLargestTurn_deg = 1e6;

/// Words of a text, as many as there is room for and one more as a sign that there are more.
struct Words {
  std::array<std::string_view, kMostWords + 1> words{};
  std::size_t count = 0;

  explicit Words(std::string_view text) {
    while (count < words.size() && !(text = trimmed(text)).empty()) {
      const std::size_t end = std::min(text.find_first_of(" \t"), text.size());
      words.at(count++) = text.substr(0, end);
      text.remove_prefix(end);
    }
  }
  /// Number of word i within bounds.
  [[nodiscard]] std::optional<double> number(std::size_t i, double least, double most) const {
    const auto value = decode_number(words.at(i));
    return value && *value >= least && *value <= most ? value : std::nullopt;
  }
};

core::Angle counter_clockwise(const ReferenceSettings& settings, double angle_deg) {
  return core::deg(static_cast<float>(settings.counts_clockwise ? -angle_deg : angle_deg));
}

Reference heading_of(const ReferenceSettings& settings, double heading_deg, core::Angle sigma,
                     core::Instant at) {
  const double wrapped_deg = std::remainder(heading_deg, 360.0);
  return app::HeadingReference{
      .time = at, .heading = counter_clockwise(settings, wrapped_deg), .sigma = sigma};
}

std::optional<core::Angle> sigma_in(const Words& words, std::size_t i) {
  const auto sigma_deg = words.number(i, 1e-6, kWidest_deg);
  if (!sigma_deg) return std::nullopt;
  return core::deg(static_cast<float>(*sigma_deg));
}

std::optional<Reference> turn_of(const ReferenceSettings& settings, const Words& words,
                                 core::Instant at) {
  const auto angle_deg = words.number(1, -kLargestTurn_deg, kLargestTurn_deg);
  const auto sigma = sigma_in(words, 2);
  const auto length_s = words.number(3, 1e-3, kLongestTurn_s);
  if (!angle_deg || !sigma || !length_s) return std::nullopt;
  const auto length = core::Duration::nanoseconds(static_cast<std::int64_t>(*length_s * 1e9));
  return app::TurnReference{.from = at - length,
                            .to = at,
                            .angle = counter_clockwise(settings, *angle_deg),
                            .sigma = *sigma};
}

}  // namespace

std::optional<Reference> decode_reference(const ReferenceSettings& settings, const Message& message,
                                          core::Instant now) {
  const core::Instant at = now - settings.latency;
  if (const auto* const heading_deg = std::get_if<double>(&message)) {
    if (!std::isfinite(*heading_deg)) return std::nullopt;
    return heading_of(settings, *heading_deg, settings.sigma, at);
  }
  const Words words{std::get<std::string_view>(message)};
  if (words.count == kMostWords && words.words[0] == "turn") return turn_of(settings, words, at);
  const auto heading_deg = words.number(0, -kLargestTurn_deg, kLargestTurn_deg);
  const auto sigma = words.count == 2 ? sigma_in(words, 1) : settings.sigma;
  if (words.count < 1 || words.count > 2 || !heading_deg || !sigma) return std::nullopt;
  return heading_of(settings, *heading_deg, *sigma, at);
}

core::Instant time_of(const Reference& reference) {
  const auto* const heading = std::get_if<app::HeadingReference>(&reference);
  return heading != nullptr ? heading->time : std::get<app::TurnReference>(reference).to;
}

std::optional<Reference> ReferenceSource::next(core::Instant now) {
  constexpr int kMostMessages = 16;  // messages of one call; the others wait for the next
  if (!messages_.open(now)) return std::nullopt;
  MessageSource::Buffer buffer{};
  for (int i = 0; i < kMostMessages; ++i) {
    const auto message = messages_.next(buffer);
    if (!message || !*message) return std::nullopt;
    if (auto reference = decode_reference(settings_, **message, now)) return reference;
    ++not_understood_;
  }
  return std::nullopt;
}

}  // namespace zerorate::linux_node
