#include "firmware/boards/linux/metrics_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "firmware/wire/health_bits.hpp"

namespace zerorate::linux_node {
namespace {

constexpr std::array<char, 3> kAxisNames{'x', 'y', 'z'};

class Text {
 public:
  explicit Text(MetricsBuffer& buffer) : buffer_(buffer) {}

  template <class... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    const auto added = fmt::format_to_n(buffer_.data() + used_, buffer_.size() - used_, format,
                                        std::forward<Arguments>(arguments)...);
    used_ = std::min(used_ + added.size, buffer_.size());
  }
  void counter(std::string_view name, std::string_view help, std::uint64_t value) {
    head(name, help, "counter");
    add("zerorate_{} {}\n", name, value);
  }
  void gauge(std::string_view name, std::string_view help, float value) {
    head(name, help, "gauge");
    add("zerorate_{} {}\n", name, value);
  }
  void head(std::string_view name, std::string_view help, std::string_view type) {
    add("# HELP zerorate_{0} {1}\n# TYPE zerorate_{0} {2}\n", name, help, type);
  }
  void rates(std::string_view name, std::string_view help, const app::RateMessage& message,
             core::AngularRate app::AxisRate::*member) {
    head(name, help, "gauge");
    for (std::size_t i = 0; i < kAxisNames.size(); ++i) {
      const float rate = (message.axes.at(i).*member).in(core::deg_per_s);
      add("zerorate_{}{{axis=\"{}\"}} {}\n", name, kAxisNames.at(i), rate);
    }
  }
  /// A line of a sink, whose name is escaped as the text format says.
  void sink(std::string_view name, const Sink& sink, std::uint64_t value) {
    add("zerorate_{}{{sink=\"", name);
    for (const char character : sink.name()) {
      if (character == '\n') {
        add("\\n");
      } else {
        add("{}{}", character == '"' || character == '\\' ? "\\" : "", character);
      }
    }
    add("\"}} {}\n", value);
  }
  /// Whole lines: of a text that did not fit, those that did.
  [[nodiscard]] std::string_view text() const {
    const std::string_view text{buffer_.data(), used_};
    return text.substr(0, text.rfind('\n') + 1);
  }

 private:
  MetricsBuffer& buffer_;
  std::size_t used_ = 0;
};

void add_counters(Text& text, const NodeService& service) {
  const app::LoopCounters& loop = service.status().counters;
  text.gauge("gyro_running", "1 while the gyro is started and answers.",
             service.status().is_running ? 1.0F : 0.0F);
  text.counter("samples_total", "Samples of the gyro.", loop.samples);
  text.counter("pulses_total", "Odometer pulses.", loop.pulses);
  text.counter("pulses_lost_total", "Odometer pulses that were dropped.", loop.pulses_lost);
  text.counter("odometer_errors_total", "Failed reads of the odometer.", loop.odometer_errors);
  text.counter("gyro_starts_total", "Successful starts of the gyro.", loop.starts);
  text.counter("gyro_start_errors_total", "Failed starts of the gyro.", loop.start_errors);
  text.counter("gyro_read_errors_total", "Failed reads of the gyro.", loop.read_errors);
  text.counter("gyro_overruns_total", "Overflows of the gyro's FIFO.", loop.overruns);
  text.counter("gyro_configurations_lost_total", "Times the gyro had lost its settings.",
               loop.configurations_lost);
  text.counter("silences_total", "Messages that said that there were no samples.", loop.silences);
  text.counter("queue_dropped_total", "Messages that the publishing thread was too slow for.",
               service.queue().dropped());
  text.counter("state_saves_total", "Saves of the state.", service.counters().saves);
  text.counter("state_save_errors_total", "Failed ones.", service.counters().save_errors);
}

void add_sinks(Text& text, const NodeService& service) {
  text.head("sink_sent_total", "Messages given to a sink.", "counter");
  for (const auto& sink : service.sinks()) {
    text.sink("sink_sent_total", *sink, sink->sent());
  }
  text.head("sink_dropped_total", "Messages that a sink could not take.", "counter");
  for (const auto& sink : service.sinks()) {
    text.sink("sink_dropped_total", *sink, sink->dropped());
  }
}

void add_message(Text& text, const app::RateMessage& message) {
  text.gauge("motion", "0 moving, 1 settling, 2 still.", static_cast<float>(message.motion));
  text.head("health", "Flags of the newest message.", "gauge");
  for (const wire::HealthBit& bit : wire::kHealthBits) {
    text.add("zerorate_health{{flag=\"{}\"}} {}\n", bit.name, message.health.*bit.flag ? 1 : 0);
  }
  if (message.calm_percent != app::RateMessage::kNoCalm) {
    text.gauge("calm_ratio", "Share of the newest stop that was calm enough to learn from.",
               static_cast<float>(message.calm_percent) / 100.0F);
  }
  text.rates("bias_dps", "Predicted bias in deg/s.", message, &app::AxisRate::bias);
  text.rates("sigma_dps", "Its standard deviation in deg/s.", message, &app::AxisRate::sigma);
}

void add_learnt_figures(Text& text, std::string_view name, std::string_view help,
                        const wire::LearntModel& learnt, const wire::LearntQuantity& quantity,
                        float app::LearntFigure::*member) {
  text.add("# HELP zerorate_learnt_{0} {1}\n# TYPE zerorate_learnt_{0} gauge\n", name, help);
  for (std::size_t i = 0; i < kAxisNames.size(); ++i) {
    text.add("zerorate_learnt_{}{{axis=\"{}\"}} {}\n", name, kAxisNames.at(i),
             learnt.axes.at(i).*quantity.figure.*member / quantity.si_per_unit);
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
  Text text(buffer);
  add_counters(text, service);
  if (service.latest()) add_message(text, service.latest()->message);
  if (service.status().learnt.is_learnt()) add_learnt(text, service.status().learnt);
  add_sinks(text, service);  // last: of sinks there may be more than find room
  return text.text();
}

}  // namespace zerorate::linux_node
