#include "host_tools/lib/recording/number.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
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

/// Takes exactly `digits` digits at the front of the text.
std::optional<int> take_number(std::string_view& text, int digits) {
  Decimal number;
  std::string_view field = text.substr(0, static_cast<std::size_t>(digits));
  if (take_digits(field, number, false) != digits) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(digits));
  return static_cast<int>(number.mantissa);
}

bool take_character(std::string_view& text, std::string_view accepted) {
  if (text.empty() || accepted.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

/// Takes "hh:mm" at the front of the text; minutes.
std::optional<int> take_hours_and_minutes(std::string_view& text) {
  const auto hours = take_number(text, 2);
  if (!hours || *hours > 23 || !take_character(text, ":")) return std::nullopt;
  const auto minutes = take_number(text, 2);
  if (!minutes || *minutes > 59) return std::nullopt;
  return *hours * 60 + *minutes;
}

std::optional<std::chrono::sys_days> take_date(std::string_view& text) {
  const auto year = take_number(text, 4);
  if (!year || !take_character(text, "-/")) return std::nullopt;
  const auto month = take_number(text, 2);
  if (!month || !take_character(text, "-/")) return std::nullopt;
  const auto day = take_number(text, 2);
  if (!day) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year{*year},
                                         std::chrono::month{static_cast<unsigned>(*month)},
                                         std::chrono::day{static_cast<unsigned>(*day)}};
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days{date};
}

/// Takes "07.250", "07,250" or "07:250" up to a zone or the end of the text; nanoseconds. A leap
/// second may follow the 59th.
std::optional<std::int64_t> take_seconds(std::string_view& text) {
  constexpr std::int64_t kNsPerSecond = 1'000'000'000;
  const auto whole = take_number(text, 2);
  if (!whole || *whole > 60) return std::nullopt;
  std::int64_t fraction_ns = 0;
  if (take_character(text, ".,:")) {
    const std::string_view digits = text.substr(0, text.find_first_of("Zz+-"));
    Decimal decimal;
    std::string_view rest = digits;
    if (digits.empty() || take_digits(rest, decimal, false) == 0 || !rest.empty())
      return std::nullopt;
    const auto fraction = parse_fixed_point(fmt::format("0.{}", digits), 9);
    if (!fraction) return std::nullopt;
    fraction_ns = fraction->value;
    text.remove_prefix(digits.size());
  }
  return *whole * kNsPerSecond + fraction_ns;
}

/// Takes "Z", "+01:00" or nothing at the front of the text; minutes ahead of UTC.
std::optional<int> take_zone(std::string_view& text) {
  if (text.empty() || take_character(text, "Zz")) return 0;
  const int sign = text.front() == '-' ? -1 : 1;
  if (!take_character(text, "+-")) return std::nullopt;
  const auto minutes = take_hours_and_minutes(text);
  if (!minutes) return std::nullopt;
  return sign * *minutes;
}

}  // namespace

std::optional<std::int64_t> parse_calendar_time(std::string_view text) {
  constexpr std::int64_t kNsPerMinute = 60'000'000'000;
  constexpr std::int64_t kNsPerDay = 1440 * kNsPerMinute;
  constexpr int kFirstYearInRange = 1900;
  constexpr int kLastYearInRange = 2110;  // within core::kLatestTime
  constexpr std::chrono::sys_days kNoDate{std::chrono::year{1970} / 1 / 1};
  const bool is_time_of_day = text.size() > 2 && text[2] == ':';
  const auto date = is_time_of_day ? kNoDate : take_date(text);
  if (!date || (!is_time_of_day && !take_character(text, "Tt "))) return std::nullopt;
  const auto minutes = take_hours_and_minutes(text);
  if (!minutes || !take_character(text, ":")) return std::nullopt;
  const auto of_minute = take_seconds(text);
  if (!of_minute) return std::nullopt;
  const auto zone = take_zone(text);
  const std::chrono::year_month_day day{*date};
  const bool is_in_range = day.year() >= std::chrono::year{kFirstYearInRange} &&
                           day.year() <= std::chrono::year{kLastYearInRange};
  if (!zone || !text.empty() || !is_in_range) return std::nullopt;
  return date->time_since_epoch().count() * kNsPerDay + (*minutes - *zone) * kNsPerMinute +
         *of_minute;
}

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
