#include "firmware/boards/linux/metrics_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/attitude.hpp"
#include "firmware/wire/explained_shares.hpp"
#include "firmware/wire/health_bits.hpp"

namespace zerorate::linux_node {
namespace {

constexpr std::array<std::string_view, 3> kAxisNames{"x", "y", "z"};

/// Text of the metrics of a node, whose name, if it has one, is a label of each sample.
class Text {
 public:
  Text(MetricsBuffer& buffer, std::string_view node) : buffer_(buffer), node_(node) {}

  void counter(std::string_view name, std::string_view help, std::uint64_t value) {
    head(name, help, "counter");
    sample(name, value);
  }
  void gauge(std::string_view name, std::string_view help, float value) {
    head(name, help, "gauge");
    sample(name, value);
  }
  void head(std::string_view name, std::string_view help, std::string_view type) {
    add("# HELP zerorate_{0} {1}\n# TYPE zerorate_{0} {2}\n", name, help, type);
  }
  /// @param key, value_of_key  a further label; none where the key is empty
  template <class Value>
  void sample(std::string_view name, Value value, std::string_view key = {},
              std::string_view value_of_key = {}) {
    add("zerorate_{}", name);
    char before = '{';
    const auto label = [&](std::string_view of, std::string_view text) {
      add("{}{}=\"", before, of);
      add_escaped(text);
      add("\"");
      before = ',';
    };
    if (!node_.empty()) label("node", node_);
    if (!key.empty()) label(key, value_of_key);
    add("{} {}\n", before == ',' ? "}" : "", value);
  }
  void rates(std::string_view name, std::string_view help, const app::RateMessage& message,
             core::AngularRate app::AxisRate::*member) {
    head(name, help, "gauge");
    for (std::size_t i = 0; i < kAxisNames.size(); ++i) {
      sample(name, (message.axes.at(i).*member).in(core::deg_per_s), "axis", kAxisNames.at(i));
    }
  }
  /// Whole lines: of a text that did not fit, those that did.
  [[nodiscard]] std::string_view text() const {
    const std::string_view text{buffer_.data(), used_};
    return text.substr(0, text.rfind('\n') + 1);
  }

 private:
  template <class... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    const auto added = fmt::format_to_n(buffer_.data() + used_, buffer_.size() - used_, format,
                                        std::forward<Arguments>(arguments)...);
    used_ = std::min(used_ + added.size, buffer_.size());
  }
  /// Value of a label as the text format wants it.
  void add_escaped(std::string_view text) {
    for (const char character : text) {
      if (character == '\n') {
        add("\\n");
      } else {
        add("{}{}", character == '"' || character == '\\' ? "\\" : "", character);
      }
    }
  }

  MetricsBuffer& buffer_;
  std::string_view node_;
  std::size_t used_ = 0;
};

void add_counters(Text& text, const NodeService& service) {
  const app::LoopCounters& loop = service.status().counters;
  text.gauge("gyro_running", "1 while the gyro is started and answers.",
             service.status().is_running ? 1.0F : 0.0F);
  text.gauge("gyro_sample_rate_hz", "Samples a second over the newest seconds.",
             service.status().sample_rate.samples_per_second());
  text.counter("samples_total", "Samples of the gyro.", loop.samples);
  text.counter("pulses_total", "Odometer pulses.", loop.pulses);
  text.counter("pulses_lost_total", "Odometer pulses that were dropped.", loop.pulses_lost);
  text.counter("foreign_stamps_total", "Edges that another clock stamped.", loop.foreign_stamps);
  text.counter("odometer_errors_total", "Failed reads of the odometer.", loop.odometer_errors);
  text.counter("gyro_starts_total", "Successful starts of the gyro.", loop.starts);
  text.counter("gyro_start_errors_total", "Failed starts of the gyro.", loop.start_errors);
  text.counter("gyro_read_errors_total", "Failed reads of the gyro.", loop.read_errors);
  text.counter("gyro_overruns_total", "Overflows of the gyro's FIFO.", loop.overruns);
  text.counter("gyro_configurations_lost_total", "Times the gyro had lost its settings.",
               loop.configurations_lost);
  const SampleCounters& samples = service.status().samples;
  text.counter("gyro_samples_lost_total", "Samples by message that never came.", samples.lost);
  text.counter("gyro_samples_late_total", "Those that came late.", samples.late);
  text.counter("gyro_samples_doubled_total", "Those that came twice.", samples.doubled);
  text.counter("gyro_samples_unreadable_total", "Messages that were no samples.",
               samples.unreadable);
  text.counter("gyro_samples_foreign_total", "Samples that another clock stamped.",
               samples.foreign);
  text.counter("sleeps_total", "Times that the machine slept.", loop.sleeps);
  text.counter("silences_total", "Messages that reported that there were no samples.",
               loop.silences);
  text.counter("queue_dropped_total", "Messages that the publishing thread was too slow for.",
               service.queue().dropped());
  text.counter("state_saves_total", "Saves of the state.", service.counters().saves);
  text.counter("state_save_errors_total", "Failed ones.", service.counters().save_errors);
}

void add_references(Text& text, const NodeService& service) {
  const ReferenceCounters& references = service.status().references;
  text.counter("references_learnt_total", "References of the heading that agreed.",
               references.learnt);
  text.counter("references_refused_total", "References too far from the gyro.", references.refused);
  text.counter("references_unusable_total", "References before a bias, or of a time long ago.",
               references.unusable);
  const auto& filter = service.status().state.turn.references.filter;
  constexpr std::size_t kState = core::HeadingFilter::kScale;
  text.gauge("scale_factor_error_percent", "Error of the scale factor as learnt, in percent.",
             100.0F * filter.x[kState]);
  text.gauge("scale_factor_sigma_percent", "Its standard deviation.",
             100.0F * core::square_root(filter.covariance(kState, kState)));
  text.gauge("learnt_references", "References that taught, restarts included.",
             static_cast<float>(filter.lessons.references));
  text.gauge("learnt_drives", "Drives in which they did.",
             static_cast<float>(filter.lessons.drives));
  const app::Heading& heading = service.status().heading;
  if (core::is_finite(heading.sigma.in(core::deg))) {
    text.gauge("heading_deg", "Heading of the vehicle, counter-clockwise.",
               heading.angle.in(core::deg));
    text.gauge("heading_sigma_deg", "Its standard deviation.", heading.sigma.in(core::deg));
  }
}

void add_sinks(Text& text, const NodeService& service) {
  text.head("sink_sent_total", "Messages given to a sink.", "counter");
  for (const auto& sink : service.sinks()) {
    text.sample("sink_sent_total", sink->sent(), "sink", sink->name());
  }
  text.head("sink_dropped_total", "Messages that a sink could not take.", "counter");
  for (const auto& sink : service.sinks()) {
    text.sample("sink_dropped_total", sink->dropped(), "sink", sink->name());
  }
}

void add_attitude(Text& text, const core::Attitude& attitude) {
  text.gauge("tilt_deg", "Angle between the sensor's z axis and the vertical.",
             attitude.tilt.in(core::deg));
  text.gauge("roll_deg", "Turn of the sensor about x from level.", attitude.roll.in(core::deg));
  text.gauge("pitch_deg", "Turn of the sensor about y from level.", attitude.pitch.in(core::deg));
}

void add_explained(Text& text, const std::array<app::ExplainedBias, 3>& explained) {
  for (const wire::ExplainedShare& share : wire::kExplainedShares) {
    text.head(share.name, "Share of the bias that this input explains, in deg/s.", "gauge");
    for (std::size_t i = 0; i < kAxisNames.size(); ++i) {
      text.sample(share.name, (explained.at(i).*share.rate).in(core::deg_per_s), "axis",
                  kAxisNames.at(i));
    }
  }
}

void add_message(Text& text, const app::RateMessage& message) {
  text.gauge("motion", "0 moving, 1 settling, 2 still.", static_cast<float>(message.motion));
  text.head("health", "Flags of the newest message.", "gauge");
  for (const wire::HealthBit& bit : wire::kHealthBits) {
    text.sample("health", message.health.*bit.flag ? 1 : 0, "flag", bit.name);
  }
  if (message.calm_percent != app::RateMessage::kNoCalm) {
    text.gauge("calm_ratio", "Share of the newest stop that was calm enough to learn from.",
               static_cast<float>(message.calm_percent) / 100.0F);
  }
  text.rates("bias_dps", "Predicted bias in deg/s.", message, &app::AxisRate::bias);
  text.rates("sigma_dps", "Its standard deviation in deg/s.", message, &app::AxisRate::sigma);
  if (message.up) add_attitude(text, core::attitude_of(*message.up));
  if (message.slope) {
    text.gauge("slope_deg", "Angle between the vertical and its mean over the stops before.",
               message.slope->in(core::deg));
  }
  if (message.vibration) {
    text.gauge("vibration_mps2", "Root mean square of the newest tick's specific force, in m/s2.",
               message.vibration->in(core::m_per_s2));
  }
  if (message.explained) add_explained(text, *message.explained);
}

void add_learnt_figures(Text& text, std::string_view quantity_name, std::string_view help,
                        const wire::LearntModel& learnt, const wire::LearntQuantity& quantity,
                        float app::LearntFigure::*member) {
  std::array<char, 64> buffer{};
  const auto end = fmt::format_to_n(buffer.data(), buffer.size(), "learnt_{}", quantity_name);
  const std::string_view name{buffer.data(), std::min(end.size, buffer.size())};
  text.head(name, help, "gauge");
  for (std::size_t i = 0; i < kAxisNames.size(); ++i) {
    text.sample(name, learnt.axes.at(i).*quantity.figure.*member / quantity.si_per_unit, "axis",
                kAxisNames.at(i));
  }
}

void add_learnt(Text& text, const wire::LearntModel& learnt) {
  text.gauge("learnt_stops", "Stops that the learnt noise rests on, older ones in part.",
             learnt.stops());
  constexpr std::array<std::string_view, 3> kHelp{
      "Order d of the flicker noise as learnt.", "Bias instability B as learnt, in deg/h.",
      "Angle random walk N as learnt, in deg/s/sqrt(Hz)."};
  static_assert(kHelp.size() == wire::kLearntQuantities.size());
  for (std::size_t i = 0; i < kHelp.size(); ++i) {
    const wire::LearntQuantity& quantity = wire::kLearntQuantities.at(i);
    add_learnt_figures(text, quantity.name, kHelp.at(i), learnt, quantity,
                       &app::LearntFigure::value);
    add_learnt_figures(text, quantity.sigma_name, "Its standard deviation.", learnt, quantity,
                       &app::LearntFigure::sigma);
  }
}

}  // namespace

std::string_view format_metrics(const NodeService& service, MetricsBuffer& buffer) {
  Text text(buffer, service.name());
  add_counters(text, service);
  if (service.latest()) add_message(text, service.latest()->message);
  if (service.status().learnt.is_learnt()) add_learnt(text, service.status().learnt);
  if (service.takes_references()) add_references(text, service);
  add_sinks(text, service);  // last: of sinks there may be more than find room
  return text.text();
}

}  // namespace zerorate::linux_node
