// Rate, status and learnt frames, and the stuffing around them: bytes of any origin, and the same
// bytes with the right checksum, as only a mad sender would make them.

#include <algorithm>
#include <vector>

#include "firmware/wire/cobs.hpp"
#include "firmware/wire/learnt_frame.hpp"
#include "firmware/wire/rate_frame.hpp"
#include "firmware/wire/rate_text.hpp"
#include "firmware/wire/status_frame.hpp"
#include "host_tests/fuzz/fuzz.hpp"
#include "host_tests/support/checksum.hpp"

namespace {

using namespace zerorate;
using Bytes = std::vector<std::uint8_t>;

void decode(std::span<const std::uint8_t> bytes) {
  if (const auto numbered = wire::decode_rate_frame(bytes)) {
    const wire::RateFrame frame = wire::encode_rate_frame(*numbered);
    fuzz::promise(wire::encode_rate_frame(*wire::decode_rate_frame(frame.bytes())) == frame,
                  "a rate frame that was decoded is encoded to what decodes the same");
    wire::TextLine line;
    fuzz::promise(wire::write_rate(numbered->message, line).size() <= line.size(),
                  "every message fits into a line of text");
  }
  if (const auto status = wire::decode_status_frame(bytes)) {
    fuzz::promise(*wire::decode_status_frame(wire::encode_status_frame(*status)) == *status,
                  "a status frame that was decoded survives being encoded");
  }
  if (const auto learnt = wire::decode_learnt_frame(bytes)) {
    fuzz::promise(*wire::decode_learnt_frame(wire::encode_learnt_frame(*learnt)) == *learnt,
                  "a learnt frame that was decoded survives being encoded");
  }
}

Bytes with_checksum(Bytes bytes) {
  if (bytes.size() < 4) return bytes;
  zerorate::testing::put_checksum(bytes);
  return bytes;
}

void unstuff(const Bytes& bytes) {
  wire::CobsReader<80> reader;
  for (const std::uint8_t byte : bytes) {
    if (const auto frame = reader.take(byte)) decode(*frame);
  }
}

void stuff_and_unstuff(const Bytes& bytes) {
  Bytes stuffed(wire::cobs_bytes(bytes.size()));
  stuffed.resize(wire::encode_cobs(bytes, stuffed));
  wire::CobsReader<4096> reader;
  bool came_back = false;
  for (const std::uint8_t byte : stuffed) {
    if (const auto frame = reader.take(byte)) came_back = std::ranges::equal(*frame, bytes);
  }
  fuzz::promise(came_back || bytes.size() > 4096, "what was stuffed comes back");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes bytes(data, data + size);
  decode(bytes);
  decode(with_checksum(bytes));
  unstuff(bytes);
  stuff_and_unstuff(bytes);
  return 0;
}
