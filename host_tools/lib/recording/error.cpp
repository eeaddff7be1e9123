#include "host_tools/lib/recording/error.hpp"

#include <fmt/format.h>

#include <utility>

namespace zerorate::recording {
namespace {

std::string describe(const Place& place) {
  if (place.line == 0) {
    return place.file;
  }
  if (place.column == 0) {
    return fmt::format("{}:{}", place.file, place.line);
  }
  return fmt::format("{}:{}:{}", place.file, place.line, place.column);
}

}  // namespace

Error::Error(Place place, std::string found, std::string expected, std::string mend)
    : DataError(
          fmt::format("{}: found {}; expected {}. {}", describe(place), found, expected, mend)),
      place_(std::move(place)),
      found_(std::move(found)),
      expected_(std::move(expected)),
      mend_(std::move(mend)) {}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string result = "\"";
  for (const char c : text.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte >= 0x7F) {
      result += fmt::format("\\x{:02X}", static_cast<unsigned>(byte));
    } else {
      result += c;
    }
  }
  result += text.size() > kLongest ? "...\"" : "\"";
  return result;
}

}  // namespace zerorate::recording
