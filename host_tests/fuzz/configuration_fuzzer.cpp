// zerorated's configuration: an error that names its place, or a configuration.

#include "firmware/boards/linux/configuration.hpp"
#include "firmware/toml/error.hpp"
#include "host_tests/fuzz/fuzz.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace zerorate;
  try {
    const auto configuration = linux_node::parse_configuration(fuzz::as_text(data, size), "fuzzed");
    fuzz::promise(linux_node::Node::check(configuration.node).has_value(),
                  "what the file may say, the node can run");
  } catch (const toml_file::Error&) {
  }
  return 0;
}
