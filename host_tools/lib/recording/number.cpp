#include "host_tools/lib/recording/number.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <limits>

namespace zerorate::recording {
namespace {

/// sign * mantissa * 10^exponent, and whether digits beyond the mantissa's 19 were dropped.
struct Decimal {
  bool negative = false;
  std::uint64_t mantissa = 0;
  int exponent = 0;
  bool dropped = false;
};

constexpr std::uint64_t kMantissaLimit = 1'000'000'000'000'000'000;  // one more digit still fits
constexpr int kExponentLimit = 100'000;  // beyond any line's length, far from overflow

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Takes the digits at the front of the text into the decimal; returns how many there were.
int take_digits(std::string_view& text, Decimal& decimal, bool fraction) {
  int count = 0;
  for (; !text.empty() && is_digit(text.front()); text.remove_prefix(1), ++count) {
    const auto digit = static_cast<std::uint64_t>(text.front() - '0');
    if (decimal.mantissa < kMantissaLimit) {
      decimal.mantissa = decimal.mantissa * 10 + digit;
      decimal.exponent -= fraction ? 1 : 0;
    } else {
      decimal.dropped = decimal.dropped || digit != 0;
      decimal.exponent += fraction ? 0 : 1;
    }
  }
  return count;
}

/// Takes a sign at the front of the text; true for minus.
bool take_sign(std::string_view& text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) {
    text.remove_prefix(1);
  }
  return negative;
}

/// Takes "e-3" and the like; false if an exponent begins but does not end well.
bool take_exponent(std::string_view& text, Decimal& decimal) {
  if (!text.starts_with('e') && !text.starts_with('E')) {
    return true;
  }
  text.remove_prefix(1);
  const bool negative = take_sign(text);
  int exponent = 0;
  const std::size_t before = text.size();
  for (; !text.empty() && is_digit(text.front()); text.remove_prefix(1)) {
    exponent = std::min(exponent * 10 + (text.front() - '0'), kExponentLimit);
  }
  decimal.exponent += negative ? -exponent : exponent;
  return text.size() != before;
}

std::optional<Decimal> parse_decimal(std::string_view text) {
  Decimal decimal;
  decimal.negative = take_sign(text);
  int digits = take_digits(text, decimal, false);
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    digits += take_digits(text, decimal, true);
  }
  if (digits == 0 || !take_exponent(text, decimal) || !text.empty()) {
    return std::nullopt;
  }
  return decimal;
}

/// mantissa * 10^exponent rounded to an integer; nullopt beyond 64 bits.
std::optional<std::uint64_t> scale(Decimal decimal, bool& exact) {
  exact = !decimal.dropped;
  for (; decimal.exponent > 0 && decimal.mantissa != 0; --decimal.exponent) {
    if (decimal.mantissa > std::numeric_limits<std::uint64_t>::max() / 10) {
      return std::nullopt;
    }
    decimal.mantissa *= 10;
  }
  std::uint64_t last_digit = 0;
  for (; decimal.exponent < 0 && (decimal.mantissa != 0 || last_digit != 0); ++decimal.exponent) {
    last_digit = decimal.mantissa % 10;
    exact = exact && last_digit == 0;
    decimal.mantissa /= 10;
  }
  return decimal.mantissa + (last_digit >= 5 ? 1 : 0);
}

}  // namespace

std::optional<FixedPoint> parse_fixed_point(std::string_view text, int decimals) {
  std::optional<Decimal> decimal = parse_decimal(text);
  if (!decimal) {
    return std::nullopt;
  }
  decimal->exponent += decimals;
  FixedPoint result{0, true};
  const std::optional<std::uint64_t> magnitude = scale(*decimal, result.exact);
  constexpr auto kLargest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  if (!magnitude || *magnitude > kLargest) {
    return std::nullopt;
  }
  const auto value = static_cast<std::int64_t>(*magnitude);
  result.value = decimal->negative ? -value : value;
  return result;
}

std::optional<double> parse_real(std::string_view text) {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (text.empty()) {
    return value;
  }
  if (text.starts_with('+') && !text.starts_with("+-")) {
    text.remove_prefix(1);
  }
  // Not std::from_chars: out of range, it leaves open whether the number is too large or too small.
  const char* const end = text.data() + text.size();
  const auto [stop, fault] = fast_float::from_chars(text.data(), end, value);
  if (fault == std::errc::invalid_argument || stop != end) {
    return std::nullopt;
  }
  return value;
}

void append_seconds(std::string& text, std::int64_t time_ns) {
  constexpr std::uint64_t kNsPerSecond = 1'000'000'000;
  const auto bits = static_cast<std::uint64_t>(time_ns);
  const std::uint64_t magnitude = time_ns < 0 ? ~bits + 1 : bits;
  fmt::format_to(std::back_inserter(text), "{}{}", time_ns < 0 ? "-" : "",
                 magnitude / kNsPerSecond);
  if (magnitude % kNsPerSecond != 0) {
    fmt::format_to(std::back_inserter(text), ".{:09}", magnitude % kNsPerSecond);
    text.erase(text.find_last_not_of('0') + 1);
  }
}

}  // namespace zerorate::recording
