/// @file
/// One order of the flicker noise for all axes of a sensor. The axes are alike, and together they
/// have more information on the order than each alone. One common question costs one price.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host_tools/lib/diagnose/hypothesis/hypothesis.hpp"
#include "host_tools/lib/diagnose/selection/selection.hpp"

namespace zerorate::diagnose {

/// The log likelihood of a record by the order of its flicker noise, all else fitted [nats]. Those
/// of several records add up.
class OrderProfile {
 public:
  /// 17 fits.
  explicit OrderProfile(const Hypothesis& without_order);

  OrderProfile& operator+=(const OrderProfile& other);
  OrderProfile& operator-=(const OrderProfile& other);

  struct Peak {
    double order = kOrderOfBase;
    double standard_error = 0.0;
    double log_likelihood = 0.0;
  };
  /// Vertex of a parabola through the best three places.
  [[nodiscard]] Peak peak() const;
  [[nodiscard]] double at_base_order() const { return values_[kBase]; }
  /// Between the places on a straight line.
  [[nodiscard]] double at(double order) const;

 private:
  static constexpr double kLowest = 0.1;
  static constexpr double kStep = 0.05;
  static constexpr std::size_t kOrders = 18;
  static constexpr std::size_t kBase = 8;  ///< 1/2

  std::array<double, kOrders> values_{};
};

/// Slow noise of one axis, in three ways. Log likelihoods are less the prices of the choices.
struct SlowNoise {
  double selected_nats = 0.0;     ///< log likelihood with the effects selected for this axis alone
  std::vector<bool> is_kept;      ///< each of its choices, beside an order in common
  double prices_of_kept = 0.0;    ///< [nats]
  OrderProfile by_order;          ///< with an order in the place of what is not kept
  double random_walk_nats = 0.0;  ///< with a random walk there
};

[[nodiscard]] SlowNoise slow_noise_of(const FitData& data, const Selection& selection);

/// The flicker noise of all axes.
struct CommonOrder {
  OrderProfile by_order;
  OrderProfile::Peak peak;
  double gain_nats = 0.0;  ///< gain over the order of the base
  double surprisal_nats = 0.0;
  std::vector<Alternative> alternatives;
  std::vector<Explanation> explanations;
};

/// An order in common, if it explains the axes together better than what was selected for each of
/// them, and better than a random walk in each; if their own orders do not refute it, and no single
/// axis speaks for it against the others.
[[nodiscard]] std::optional<CommonOrder> common_order_of(std::span<const SlowNoise> axes);

/// The part that stands for an order.
[[nodiscard]] Part part_of_order(const OrderProfile::Peak& peak);

/// Puts the order in common into the place of an axis's own slow noise.
/// @param effects with fractional_order among them  @param axes that have it in common
void replace_slow_noise(const CommonOrder& common, std::span<const std::unique_ptr<Effect>> effects,
                        std::size_t axes, const SlowNoise& slow_noise, Selection& selection);

}  // namespace zerorate::diagnose
