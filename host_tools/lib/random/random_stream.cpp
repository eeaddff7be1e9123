#include "host_tools/lib/random/random_stream.hpp"

#include <bit>
#include <cmath>

namespace zerorate::random {
namespace {

constexpr int kPhiloxRounds = 10;

// The finaliser of splitmix64 (Steele, Lea and Flood 2014): a bijection of 64 bits.
std::uint64_t mix(std::uint64_t z) {
  z += 0x9E3779B97F4A7C15U;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

// The middle of one of 2^53 equal intervals, hence never 0 or 1.
double to_uniform(std::uint64_t bits) {
  return (static_cast<double>(bits >> 12U) + 0.5) * 0x1.0p-52;
}

// log(x) for normal x > 0 by 2 atanh((m - 1) / (m + 1)), m in [sqrt(1/2), sqrt(2)). Not std::log,
// whose last bit differs from library to library.
double reproducible_log(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  auto exponent = static_cast<double>(bits >> 52U) - 1023.0;
  auto mantissa = std::bit_cast<double>((bits & 0xFFFFFFFFFFFFFU) | 0x3FF0000000000000U);
  if (mantissa > 1.4142135623730951) {
    mantissa *= 0.5;
    exponent += 1.0;
  }
  const double t = (mantissa - 1.0) / (mantissa + 1.0);
  const double square = t * t;  // at most 0.0295: twelve terms leave 1e-19
  double series = 0.0;
  for (int odd = 23; odd >= 1; odd -= 2) series = series * square + 1.0 / odd;
  return exponent * 0.6931471805599453 + 2.0 * t * series;
}

template <std::size_t n>
double polynomial(const std::array<double, n>& coefficients, double x) {
  double sum = 0.0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) sum = sum * x + *c;
  return sum;
}

// Coefficients of AS 241, PPND16: numerator and denominator for centre, shoulders and far tails.
constexpr std::array kA{3.3871328727963666080,    1.3314166789178437745e+2,
                        1.9715909503065514427e+3, 1.3731693765509461125e+4,
                        4.5921953931549871457e+4, 6.7265770927008700853e+4,
                        3.3430575583588128105e+4, 2.5090809287301226727e+3};
constexpr std::array kB{1.0,
                        4.2313330701600911252e+1,
                        6.8718700749205790830e+2,
                        5.3941960214247511077e+3,
                        2.1213794301586595867e+4,
                        3.9307895800092710610e+4,
                        2.8729085735721942674e+4,
                        5.2264952788528545610e+3};
constexpr std::array kC{1.42343711074968357734,    4.63033784615654529590,
                        5.76949722146069140550,    3.64784832476320460504,
                        1.27045825245236838258,    2.41780725177450611770e-1,
                        2.27238449892691845833e-2, 7.74545014278341407640e-4};
constexpr std::array kD{1.0,
                        2.05319162663775882187,
                        1.67638483018380384940,
                        6.89767334985100004550e-1,
                        1.48103976427480074590e-1,
                        1.51986665636164571966e-2,
                        5.47593808499534494600e-4,
                        1.05075007164441684324e-9};
constexpr std::array kE{6.65790464350110377720,    5.46378491116411436990,
                        1.78482653991729133580,    2.96560571828504891230e-1,
                        2.65321895265761230930e-2, 1.24266094738807843860e-3,
                        2.71155556874348757815e-5, 2.01033439929228813265e-7};
constexpr std::array kF{1.0,
                        5.99832206555887937690e-1,
                        1.36929880922735805310e-1,
                        1.48753612908506148525e-2,
                        7.86869131145613259100e-4,
                        1.84631831751005468180e-5,
                        1.42151175831644588870e-7,
                        2.04426310338993978564e-15};

}  // namespace

std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < kPhiloxRounds; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53U} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57U} * counter[2];
    counter = {
        static_cast<std::uint32_t>(b >> 32U) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
        static_cast<std::uint32_t>(a >> 32U) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9U;
    key[1] += 0xBB67AE85U;
  }
  return counter;
}

double normal_quantile(double p) {
  const double q = p - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * polynomial(kA, r) / polynomial(kB, r);
  }
  const double r = std::sqrt(-reproducible_log(q < 0.0 ? p : 1.0 - p));
  const double magnitude = r <= 5.0 ? polynomial(kC, r - 1.6) / polynomial(kD, r - 1.6)
                                    : polynomial(kE, r - 5.0) / polynomial(kF, r - 5.0);
  return q < 0.0 ? -magnitude : magnitude;
}

RandomStream RandomStream::substream(std::uint64_t id) const {
  return RandomStream(seed_, mix(stream_ ^ mix(id)));
}

RandomStream RandomStream::substream(std::string_view name) const {
  std::uint64_t hash = 0xCBF29CE484222325U;  // FNV-1a
  for (const char c : name) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
  }
  return substream(hash);
}

std::array<std::uint64_t, 2> RandomStream::pair(std::int64_t index) const {
  const auto position = static_cast<std::uint64_t>(index);
  const auto low = [](std::uint64_t x) { return static_cast<std::uint32_t>(x); };
  const auto high = [](std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32U); };
  const auto block = philox4x32({low(position), high(position), low(stream_), high(stream_)},
                                {low(seed_), high(seed_)});
  return {block[0] | std::uint64_t{block[1]} << 32U, block[2] | std::uint64_t{block[3]} << 32U};
}

std::uint64_t RandomStream::bits(std::int64_t k) const {
  return pair(k >> 1)[static_cast<std::size_t>(k & 1)];
}

double RandomStream::uniform(std::int64_t k) const {
  return to_uniform(bits(k));
}

double RandomStream::normal(std::int64_t k) const {
  return normal_quantile(uniform(k));
}

void RandomStream::fill_normal(std::int64_t first, std::span<double> values) const {
  std::size_t i = 0;
  if (!values.empty() && first % 2 != 0) values[i++] = normal(first);
  for (; i + 2 <= values.size(); i += 2) {
    const auto both = pair((first + static_cast<std::int64_t>(i)) >> 1);
    values[i] = normal_quantile(to_uniform(both[0]));
    values[i + 1] = normal_quantile(to_uniform(both[1]));
  }
  if (i < values.size()) values[i] = normal(first + static_cast<std::int64_t>(i));
}

}  // namespace zerorate::random
