/// @file
/// Models of which one figure cannot be.
#pragma once

#include <gtest/gtest.h>
#include <zerorate.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace zerorate::c_api::testing {

/// Whether the four bytes at an offset of the model are a figure that means something, or the
/// quantity of an input.
[[nodiscard]] inline bool is_figure_at(const zerorate_model& model, std::size_t offset) {
  // The time constant of a mode that does nothing.
  for (std::size_t i = 0; i < ZERORATE_DECAYING_MODES; ++i) {
    const std::size_t begin = offsetof(zerorate_model, decaying) + i * sizeof model.decaying[0];
    const zerorate_decaying_mode& mode = model.decaying[i];
    if (offset == begin && mode.noise_variance == 0.0F && mode.initial_variance == 0.0F)
      return false;
  }
  return offset != offsetof(zerorate_model, gate_longest_knock_ticks) &&
         offset != offsetof(zerorate_model, hypothesis_count);
}

/// Result of zerorate_init() for a model with `value` in the place of the four bytes at `offset`.
[[nodiscard]] inline zerorate_result result_with(zerorate_model model, std::size_t offset,
                                                 float value) {
  std::memcpy(static_cast<unsigned char*>(static_cast<void*>(&model)) + offset, &value,
              sizeof value);
  zerorate_node node;
  return zerorate_init(&node, &model, nullptr);
}

/// Every figure in turn is no number, infinite, or far beyond what a gyro can have.
inline void expect_each_impossible_figure_refused(const zerorate_model& model) {
  ASSERT_GT(model.hypothesis_count, 0) << "else the hypotheses are not looked at";
  constexpr std::size_t kLast = offsetof(zerorate_model, hypotheses) + sizeof model.hypotheses;
  for (std::size_t at = offsetof(zerorate_model, walk_variance_rad2_s2); at < kLast; at += 4) {
    if (!is_figure_at(model, at)) continue;
    for (const float value : {NAN, INFINITY, -INFINITY, 1e30F, -1e30F}) {
      EXPECT_EQ(result_with(model, at, value), ZERORATE_BAD_MODEL) << at << ' ' << value;
    }
  }
}

}  // namespace zerorate::c_api::testing
