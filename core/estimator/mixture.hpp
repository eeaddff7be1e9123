/// @file
/// Mean and variance of a mixture of forecasts.
#pragma once

namespace zerorate::core {

/// Mean and variance of forecasts by their weights. Means are taken from that of the first, so that
/// nothing large cancels.
/// @tparam IsOfSeveral false: one forecast, which is the answer itself
template <bool IsOfSeveral>
class Mixture {
 public:
  constexpr bool operator==(const Mixture&) const = default;

  constexpr void add(float weight, float mean, float variance) {
    if constexpr (!IsOfSeveral) {
      origin_ = mean;
      variance_ = variance;
      return;
    }
    if (is_empty_) origin_ = mean;
    is_empty_ = false;
    const float apart = mean - origin_;
    apart_ += weight * apart;
    variance_ += weight * (variance + apart * apart);
  }
  [[nodiscard]] constexpr float mean() const { return IsOfSeveral ? origin_ + apart_ : origin_; }
  [[nodiscard]] constexpr float variance() const {
    return IsOfSeveral ? variance_ - apart_ * apart_ : variance_;
  }

 private:
  float origin_ = 0.0F;
  float apart_ = 0.0F;
  float variance_ = 0.0F;
  bool is_empty_ = true;
};

}  // namespace zerorate::core
