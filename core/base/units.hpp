/// @file
/// Physical quantities in SI, entered and left only by naming a unit:
///
///     AngularRate rate = deg_per_s(1.5F);
///     float shown = rate.in(deg_per_h);
///
/// A quantity is one float and costs nothing. Different dimensions do not mix (compile_fail tests).
#pragma once

#include <compare>
#include <numbers>

#include "core/base/time.hpp"

namespace zerorate::core {

template <class Dimension>
class Unit;

/// A number with a dimension; the SI unit of the dimension is inside and not visible.
template <class Dimension>
class Quantity {
 public:
  constexpr Quantity() = default;
  [[nodiscard]] constexpr float in(Unit<Dimension> unit) const { return si_ / unit.si_per_unit(); }

  constexpr auto operator<=>(const Quantity&) const = default;
  constexpr Quantity operator-() const { return Quantity{-si_}; }
  friend constexpr Quantity operator+(Quantity a, Quantity b) { return Quantity{a.si_ + b.si_}; }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return Quantity{a.si_ - b.si_}; }
  friend constexpr Quantity operator*(Quantity a, float k) { return Quantity{a.si_ * k}; }
  friend constexpr Quantity operator*(float k, Quantity a) { return a * k; }
  friend constexpr Quantity operator/(Quantity a, float k) { return Quantity{a.si_ / k}; }
  friend constexpr float operator/(Quantity a, Quantity b) { return a.si_ / b.si_; }

 private:
  friend class Unit<Dimension>;
  constexpr explicit Quantity(float si) : si_(si) {}
  float si_ = 0.0F;
};

/// A unit of one dimension: calling it with a number makes a quantity.
template <class Dimension>
class Unit {
 public:
  constexpr explicit Unit(float si_per_unit) : si_per_unit_(si_per_unit) {}
  constexpr Quantity<Dimension> operator()(float number) const {
    return Quantity<Dimension>{number * si_per_unit_};
  }
  [[nodiscard]] constexpr float si_per_unit() const { return si_per_unit_; }

 private:
  float si_per_unit_;
};

using Acceleration = Quantity<struct AccelerationDimension>;
using Angle = Quantity<struct AngleDimension>;
using AngularRate = Quantity<struct AngularRateDimension>;
using Frequency = Quantity<struct FrequencyDimension>;
using TemperatureDifference = Quantity<struct TemperatureDimension>;

inline constexpr float kRadPerDeg = std::numbers::pi_v<float> / 180.0F;

inline constexpr float kStandardGravity_m_s2 = 9.80665F;  // 3rd CGPM, 1901

inline constexpr Unit<AccelerationDimension> m_per_s2{1.0F};
inline constexpr Unit<AccelerationDimension> standard_gravity{kStandardGravity_m_s2};
inline constexpr Unit<AngleDimension> rad{1.0F};
inline constexpr Unit<AngleDimension> deg{kRadPerDeg};
inline constexpr Unit<AngularRateDimension> rad_per_s{1.0F};
inline constexpr Unit<AngularRateDimension> deg_per_s{kRadPerDeg};
inline constexpr Unit<AngularRateDimension> deg_per_h{kRadPerDeg / 3600.0F};
inline constexpr Unit<FrequencyDimension> hz{1.0F};
inline constexpr Unit<TemperatureDimension> kelvin{1.0F};

constexpr Angle operator*(AngularRate rate, Duration time) {
  return rad(rate.in(rad_per_s)*time.in_seconds());
}

/// A temperature on the Celsius scale: a point, not a difference. Two points cannot be added.
class Temperature {
 public:
  constexpr Temperature() = default;
  [[nodiscard]] static constexpr Temperature from_degc(float degc) { return Temperature{degc}; }
  [[nodiscard]] constexpr float degc() const { return degc_; }
  constexpr auto operator<=>(const Temperature&) const = default;
  friend constexpr TemperatureDifference operator-(Temperature a, Temperature b) {
    return kelvin(a.degc_ - b.degc_);
  }

 private:
  constexpr explicit Temperature(float degc) : degc_(degc) {}
  float degc_ = 0.0F;
};

}  // namespace zerorate::core
