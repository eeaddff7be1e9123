// A line of zerorated's output: a message, or none.

#include "firmware/wire/rate_frame.hpp"
#include "host_tests/fuzz/fuzz.hpp"
#include "host_tools/lib/live/source.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace zerorate;
  if (const auto line = live::parse_json_message(fuzz::as_text(data, size))) {
    const wire::RateFrame frame = wire::encode_rate_frame(line->message);
    fuzz::promise(wire::decode_rate_frame(frame.bytes()).has_value(),
                  "a message that was read is one that a frame can carry");
    fuzz::promise(
        !line->learnt ||
            wire::decode_learnt_frame(wire::encode_learnt_frame(*line->learnt)).has_value(),
        "a learnt model that was read is one that a frame can carry");
  }
  return 0;
}
