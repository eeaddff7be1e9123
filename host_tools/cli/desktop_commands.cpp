#include "host_tools/cli/commands.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "firmware/model/catalogue.hpp"
#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/live/page/page.hpp"
#include "host_tools/lib/recording/reader.hpp"

namespace zerorate::cli {
namespace {

ShowTally open_page(const std::string& address, std::uint16_t port) {
  const auto page = std::make_shared<live::Page>(address, port);
  fmt::print(stderr, "live page: {}\n", page->url());
  return [page](const live::Tally& tally, const std::string& source,
                std::chrono::milliseconds silence) { page->show(tally, source, silence); };
}

/// Replays the recording. Without a column of the odometer or of rest, the gyro alone decides what
/// is rest.
void play_recording(const std::string& recording, const std::string& model,
                    const std::function<void(const wire::NumberedMessage&)>& take) {
  recording::Reader reader{recording};
  const recording::Columns& columns = reader.columns();
  evaluate::ReplayOptions options{.model = model::load_model(model)};
  if (!columns.odometer && !columns.still) {
    options.standstill.source = core::StandstillSource::gyro;
  }
  const std::size_t axis_count = columns.axis_count;
  evaluate::ReplayObserver observer;
  observer.on_sample = [&](const evaluate::ReplayedSample& sample) {
    wire::NumberedMessage numbered{.sequence = static_cast<std::uint32_t>(sample.row),
                                   .message = sample.message};
    // A recording of one axis drives all three.
    for (std::size_t i = axis_count; i < 3; ++i) numbered.message.turn[i].angle = {};
    take(numbered);
  };
  (void)evaluate::replay(reader, options, observer);
}

}  // namespace

std::vector<Command> add_commands(CLI::App& app) {
  return {add_replay(app),       add_demo(app),
          add_characterize(app), add_model(app),
          add_export(app),       add_evaluate(app),
          add_diagnose(app),     add_monitor(app, open_page),
          add_probe(app),        add_record(app),
          add_simulate(app),     add_odometer(app),
          add_convert(app),      add_fleet(app),
          add_accept(app),       add_calibrate(app, play_recording),
          add_compare(app)};
}

}  // namespace zerorate::cli
