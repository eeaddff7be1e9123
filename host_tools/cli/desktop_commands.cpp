#include "host_tools/cli/commands.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "host_tools/lib/live/page/page.hpp"

namespace zerorate::cli {
namespace {

ShowTally open_page(const std::string& address, std::uint16_t port) {
  const auto page = std::make_shared<live::Page>(address, port);
  fmt::print(stderr, "live page: {}\n", page->url());
  return [page](const live::Tally& tally, const std::string& source,
                std::chrono::milliseconds silence) { page->show(tally, source, silence); };
}

}  // namespace

std::vector<Command> add_commands(CLI::App& app) {
  return {add_replay(app),  add_demo(app),     add_characterize(app), add_model(app),
          add_export(app),  add_evaluate(app), add_diagnose(app),     add_monitor(app, open_page),
          add_probe(app),   add_record(app),   add_simulate(app),     add_odometer(app),
          add_convert(app), add_fleet(app),    add_accept(app)};
}

}  // namespace zerorate::cli
