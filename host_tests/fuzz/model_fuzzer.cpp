// A model file: an error that names its place, or a model that survives being written and read.

#include <stdexcept>

#include "core/base/time.hpp"
#include "firmware/model/model_file.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/fuzz/fuzz.hpp"

namespace {

using namespace zerorate;

void run_on_the_node(const model::SensorModel& sensor) {
  using core::Duration;
  try {
    (void)model::make_full_node_model(sensor, Duration::milliseconds(10),
                                      Duration::milliseconds(500));
  } catch (const std::invalid_argument&) {
    // A model that a file can hold need not fit the node; it is refused with a reason.
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const model::SensorModel sensor = model::parse_model(fuzz::as_text(data, size), "fuzzed");
    const std::string text = model::format_model(sensor);
    fuzz::promise(model::format_model(model::parse_model(text, "written")) == text,
                  "a model that was read is written so that it reads the same");
    run_on_the_node(sensor);
  } catch (const model::ModelFileError&) {
  }
  return 0;
}
