
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/boards/linux/node_service.hpp"
#include "firmware/boards/linux/process/process.hpp"
#include "firmware/boards/linux/simulated_vehicle.hpp"
#include "hal/linux/standard_output.hpp"
#include "host_tools/cli/live_options.hpp"

namespace zerorate::cli {
namespace {

using linux_node::Configuration;

/// A string of TOML: the escapes are those of JSON.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The configuration that the options describe: a gyro without an odometer. The filter's model is
/// any one, because a recording holds what was measured.
std::string configuration_of(const ChipOptions& options) {
  std::string text = "schema = \"zerorate.daemon/1\"\n[model]\nname = \"lsm6dso\"\n";
  const bool is_simulated = options.chip == "simulated";
  if (!is_simulated) text += "[standstill]\nsource = \"gyro\"\n";
  text += fmt::format("[gyro]\nchip = {}\n", quoted(options.chip));
  if (!options.spi.empty()) text += "bus = \"spi\"\ndevice = " + quoted(options.spi) + "\n";
  if (!options.i2c.empty()) text += "bus = \"i2c\"\ndevice = " + quoted(options.i2c) + "\n";
  if (!options.address.empty()) text += "address = " + options.address + "\n";
  if (!options.rate_hz.empty()) text += "rate_hz = " + options.rate_hz + "\n";
  if (!options.full_scale_dps.empty()) {
    text += "full_scale_dps = " + options.full_scale_dps + "\n";
  }
  return text;
}

Configuration read_configuration(const ChipOptions& options) {
  Configuration configuration =
      options.chip.empty()
          ? linux_node::read_configuration(options.configuration)
          : linux_node::parse_configuration(configuration_of(options), "options of the chip");
  configuration.sinks.clear();
  return configuration;
}

/// Keeps messages until they are fetched.
class KeepingSink final : public linux_node::Sink {
 public:
  explicit KeepingSink(std::vector<wire::NumberedMessage>& kept) : Sink("recording"), kept_(kept) {}

 private:
  bool send(const wire::NumberedMessage& message) override {
    kept_.push_back(message);
    return true;
  }
  std::vector<wire::NumberedMessage>& kept_;
};

void log(std::string_view line) {
  fmt::print(stderr, "zerorate: {}\n", hal::linux_os::printable(line));
}

/// A node that publishes to this program alone. Its state is neither taken up nor saved.
class ChipSource final : public live::Source {
 public:
  explicit ChipSource(Configuration configuration)
      : Source(describe(configuration)), configuration_(std::move(configuration)) {
    if (configuration_.state) state_lock_ = linux_node::lock_state(configuration_.state->file);
    configuration_.state.reset();
    service_.emplace(configuration_, *hardware_, nullptr, linux_node::read_boot_id(), log);
    service_->add_sink(std::make_unique<KeepingSink>(kept_));
    thread_.emplace(
        configuration_.real_time.priority, [this] { service_->measure(); },
        [this] { hardware_->wake(); }, log);
  }

  [[nodiscard]] int descriptor() const override { return service_->queue().waiting().descriptor(); }
  bool receive(live::Tally& tally) override {
    service_->publish_waiting();
    for (const wire::NumberedMessage& message : kept_) tally.take(message);
    kept_.clear();
    // A node sends a message four times a second even where its gyro is silent.
    const auto now = std::chrono::steady_clock::now();
    if (now - ticked_at_ >= std::chrono::seconds(1)) {
      ticked_at_ = now;
      (void)service_->tick();
    }
    return true;
  }

 private:
  Configuration configuration_;
  std::unique_ptr<linux_node::Hardware> hardware_ = make_hardware(configuration_);
  hal::linux_os::Descriptor state_lock_;
  std::vector<wire::NumberedMessage> kept_;
  std::optional<linux_node::NodeService> service_;
  std::optional<linux_node::MeasuringThread> thread_;
  std::chrono::steady_clock::time_point ticked_at_;
};

}  // namespace

std::string model_of_chip(const ChipOptions& options) {
  return read_configuration(options).model_name;
}

std::unique_ptr<live::Source> open_chip(const ChipOptions& options) {
  return std::make_unique<ChipSource>(read_configuration(options));
}

}  // namespace zerorate::cli
