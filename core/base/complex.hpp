/// @file
/// Complex arithmetic for an oscillating mode. std::complex would pull in the library routine for
/// infinities; our numbers are finite.
#pragma once

namespace zerorate::core {

struct Complex {
  float re = 0.0F;
  float im = 0.0F;

  constexpr Complex() = default;
  // Implicit on purpose: a real number is a complex one, and formulas are written once for both.
  // NOLINTNEXTLINE(google-explicit-constructor)
  constexpr Complex(float real, float imaginary = 0.0F) : re(real), im(imaginary) {}

  constexpr bool operator==(const Complex&) const = default;
  constexpr Complex operator-() const { return {-re, -im}; }
};

// No friends: GCC's `#pragma GCC optimize`, with which zerorate.cpp keeps its bits, ignores them.
[[nodiscard]] constexpr Complex operator+(Complex a, Complex b) {
  return {a.re + b.re, a.im + b.im};
}
[[nodiscard]] constexpr Complex operator-(Complex a, Complex b) {
  return {a.re - b.re, a.im - b.im};
}
[[nodiscard]] constexpr Complex operator*(Complex a, Complex b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

// Real numbers with the same three words, so that one formula serves decaying and rotating modes.
[[nodiscard]] constexpr float conjugate(float x) {
  return x;
}
[[nodiscard]] constexpr Complex conjugate(Complex x) {
  return {x.re, -x.im};
}
[[nodiscard]] constexpr float real_part(float x) {
  return x;
}
[[nodiscard]] constexpr float real_part(Complex x) {
  return x.re;
}
[[nodiscard]] constexpr float squared_magnitude(float x) {
  return x * x;
}
[[nodiscard]] constexpr float squared_magnitude(Complex x) {
  return x.re * x.re + x.im * x.im;
}

}  // namespace zerorate::core
