#include "host_tools/lib/live/view.hpp"

#include <fmt/format.h>

#include "core/base/attitude.hpp"
#include "core/base/numeric.hpp"
#include "firmware/wire/explained_shares.hpp"
#include "firmware/wire/health_bits.hpp"
#include "host_tools/lib/statistics/half_width.hpp"

namespace zerorate::live {
namespace {

constexpr float kPerHour = 3600.0F;

std::string number(bool is_known, float value, int decimals) {
  return is_known && core::is_finite(value) ? fmt::format("{:+.{}f}", value, decimals) : "-";
}

/// The three figures of an axis; "-" for a figure that the message lacks.
struct Figures {
  std::string rate_dps, bias_dps, interval_dph;
};

/// Turn since departure with its 95 % interval.
std::string turn_text(const app::AxisTurn& turn, bool is_present) {
  const float sigma_deg = turn.sigma.in(core::deg);
  if (!is_present || !core::is_finite(sigma_deg)) return "-";
  return fmt::format("{:+.1f} +- {:.1f}", turn.angle.in(core::deg),
                     sigma_deg * static_cast<float>(statistics::kHalfWidth95));
}

Figures figures_of(const app::RateMessage& message, const app::AxisRate& axis, bool is_present) {
  const bool is_calibrated = message.health.calibrated;
  const float sigma_dps = axis.sigma.in(core::deg_per_s);
  return {
      .rate_dps = number(is_present && message.has_rate(), axis.corrected.in(core::deg_per_s), 5),
      .bias_dps = number(is_calibrated, axis.bias.in(core::deg_per_s), 5),
      .interval_dph =
          is_calibrated && core::is_finite(sigma_dps)
              ? fmt::format("{:.2f}",
                            sigma_dps * static_cast<float>(statistics::kHalfWidth95) * kPerHour)
              : "-"};
}

std::string format_counters(const wire::Status& status) {
  const app::LoopCounters& counters = status.counters;
  return fmt::format("node: {} samples, {} pulses, {} starts, {} read errors, {} frames dropped\n",
                     counters.samples, counters.pulses, counters.starts, counters.read_errors,
                     status.frames_dropped);
}

/// A figure with its standard deviation, three digits of each.
std::string figure_text(const app::LearntNoise& axis, const wire::LearntQuantity& quantity) {
  const app::LearntFigure& figure = axis.*quantity.figure;
  return fmt::format("{:#.3g} +- {:#.2g}", figure.value / quantity.si_per_unit,
                     figure.sigma / quantity.si_per_unit);
}

/// Rate and heading about the vertical, where its axis is given.
std::string vertical_line(const app::RateMessage& message, bool is_heard) {
  if (!message.up) return {};
  const bool has_rate = is_heard && message.has_rate();
  return fmt::format(
      "about the vertical: {} deg/s, heading {} deg, counter-clockwise\n",
      number(has_rate, has_rate ? message.vertical_rate().in(core::deg_per_s) : 0.0F, 3),
      turn_text({.angle = message.heading.angle, .sigma = message.heading.sigma}, is_heard));
}

/// Attitude of the sensor by the direction that points up, and its vibration.
std::string attitude_line(const app::RateMessage& message, bool is_heard) {
  std::string words;
  if (message.up && is_heard) {
    const core::Attitude attitude = core::attitude_of(*message.up);
    words =
        fmt::format("tilt {:.1f} deg (roll {:+.1f}, pitch {:+.1f})", attitude.tilt.in(core::deg),
                    attitude.roll.in(core::deg), attitude.pitch.in(core::deg));
    if (message.slope) words += fmt::format(", slope {:.1f} deg", message.slope->in(core::deg));
  }
  if (message.vibration && is_heard) {
    words += fmt::format("{}vibration {:.4f} g", words.empty() ? "" : ", ",
                         message.vibration->in(core::standard_gravity));
  }
  return words.empty() ? words : words + "\n";
}

/// Shares of the bias of each axis by input, where the model has inputs.
std::string explained_lines(const app::RateMessage& message, bool is_heard) {
  if (!message.explained || !is_heard) return {};
  std::string text =
      fmt::format("{:22} {:>12} {:>12} {:>12}\n", "bias explained, deg/s", "x", "y", "z");
  for (const wire::ExplainedShare& share : wire::kExplainedShares) {
    text += fmt::format("  by {:17}", share.input);
    for (const app::ExplainedBias& axis : *message.explained) {
      text += fmt::format(" {:>12}", number(true, (axis.*share.rate).in(core::deg_per_s), 5));
    }
    text += "\n";
  }
  return text;
}

std::string calm_line(const app::RateMessage& message) {
  if (message.calm_percent == app::RateMessage::kNoCalm) return {};
  return fmt::format("newest stop: {} % calm\n", message.calm_percent);
}

/// Lines of less than 80 characters, broken at spaces: a terminal that wrapped them itself would
/// have more lines than were counted.
std::string wrapped(std::string text) {
  constexpr std::size_t kWidth = 79;
  for (std::size_t begin = 0; text.size() - begin > kWidth;) {
    const std::size_t space = text.rfind(' ', begin + kWidth);
    if (space == std::string::npos || space < begin) break;
    text[space] = '\n';
    begin = space + 1;
  }
  return text;
}

}  // namespace

std::string describe(const app::Health& health) {
  std::string words = health.calibrated ? "" : "not calibrated";
  for (const wire::HealthBit& bit : wire::kHealthBits) {
    if (bit.flag == &app::Health::calibrated || !(health.*bit.flag)) continue;
    words += fmt::format("{}{}", words.empty() ? "" : ", ", bit.name);
  }
  return words.empty() ? "fine" : words;
}

std::string format_screen(const Tally& tally, std::string_view source,
                          std::chrono::milliseconds silence) {
  std::string text = fmt::format("{}: {} messages, {} lost, {} damaged", source, tally.messages,
                                 tally.lost, tally.damaged);
  text += tally.restarts > 0 ? fmt::format(", {} restarts\n", tally.restarts) : "\n";
  const bool is_heard = is_present(tally, silence);
  if (!is_heard) {
    text += fmt::format("no message for {} s\n", silence.count() / 1000);
  } else {
    text += wrapped(fmt::format("{}: {}", core::name(tally.newest->message.motion),
                                describe(tally.newest->message.health))) +
            "\n" + calm_line(tally.newest->message);
  }
  text += fmt::format("{:3} {:>14} {:>13} {:>17} {:>20}\n", "", "rate deg/s", "bias deg/s",
                      "95 % +- deg/h", "turn deg, 95 %");
  const app::RateMessage message = tally.newest ? tally.newest->message : app::RateMessage{};
  for (std::size_t i = 0; i < message.axes.size(); ++i) {
    const Figures axis = figures_of(message, message.axes.at(i), is_heard);
    text += fmt::format("{:3} {:>14} {:>13} {:>17} {:>20}\n", "xyz"[i], axis.rate_dps,
                        axis.bias_dps, axis.interval_dph, turn_text(message.turn.at(i), is_heard));
  }
  text += vertical_line(message, is_heard) + attitude_line(message, is_heard) +
          explained_lines(message, is_heard);
  text += format_learnt(tally);
  if (tally.status) text += format_counters(*tally.status);
  return text;
}

std::string format_learnt(const Tally& tally) {
  if (!tally.learnt || !tally.learnt->is_learnt()) return {};
  std::string text = fmt::format(
      "learnt from {:.1f} stops (+- one standard deviation):\n"
      "{:3} {:>15} {:>22} {:>26}\n",
      tally.learnt->stops(), "", "order d", "B deg/h", "N deg/s/sqrt(Hz)");
  for (std::size_t i = 0; i < tally.learnt->axes.size(); ++i) {
    const app::LearntNoise& axis = tally.learnt->axes.at(i);
    text += fmt::format("{:3} {:>15} {:>22} {:>26}\n", "xyz"[i],
                        figure_text(axis, wire::kLearntQuantities[0]),
                        figure_text(axis, wire::kLearntQuantities[1]),
                        figure_text(axis, wire::kLearntQuantities[2]));
  }
  return text;
}

std::string_view line_header() {
  return "     time s motion     rate x, y, z deg/s               bias x, y, z deg/s"
         "               95 % +- x, y, z deg/h     health\n";
}

std::string format_line(const Tally& tally) {
  const app::RateMessage& message = tally.newest->message;
  const std::int64_t milliseconds = message.time.ns() / 1'000'000;
  std::string text = fmt::format("{:7}.{:03} {:<8}", milliseconds / 1000, milliseconds % 1000,
                                 core::name(message.motion));
  for (const auto figure : {&Figures::rate_dps, &Figures::bias_dps}) {
    for (const app::AxisRate& axis : message.axes) {
      text += fmt::format(" {:>10}", figures_of(message, axis, true).*figure);
    }
  }
  for (const app::AxisRate& axis : message.axes) {
    text += fmt::format(" {:>8}", figures_of(message, axis, true).interval_dph);
  }
  return text + "  " + describe(message.health) + "\n";
}

}  // namespace zerorate::live
