// A real sensor whose samples are cut toward zero, moved by hand with rests between (BROAD, Laidig
// et al. 2021): the bias that is learnt at rest against an optical reference on the move. The
// figures stand in docs/reference/scenarios.md.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/app/gyro_node.hpp"
#include "firmware/model/catalogue.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lib/recording/byte_source.hpp"

namespace zerorate::scenario {
namespace {

constexpr double kDps = std::numbers::pi / 180.0;
constexpr double kStep_dps = 2000.0 / 32768.0;  // the full scale over 15 bits
constexpr auto kPeriod = core::Duration::microseconds(3500);
constexpr core::ModelShape kShape{.decaying = 6, .hypotheses = 12};
using HandHeldNode = app::GyroNode<kShape>;

struct Row {
  double time_s = 0.0;
  std::array<double, 3> rate_dps{};
  bool is_still = false;
  std::array<double, 3> reference_dps{};  ///< not a number where the cameras lost it
};

/// t_s, three rates, still, and the reference's rates about z, x and y.
std::vector<Row> read_rows(const std::filesystem::path& file) {
  recording::LineReader lines{file};
  std::vector<Row> rows;
  std::string_view line;
  (void)lines.next(line);  // the header
  while (lines.next(line)) {
    std::array<double, 8> fields{};
    for (double& field : fields) {
      const std::string text{line.substr(0, line.find(','))};
      field = text.empty() ? std::numeric_limits<double>::quiet_NaN() : std::stod(text);
      line.remove_prefix(std::min(text.size() + 1, line.size()));
    }
    rows.push_back({fields[0],
                    {fields[1], fields[2], fields[3]},
                    fields[4] == 1.0,
                    {fields[6], fields[7], fields[5]}});
  }
  return rows;
}

HandHeldNode::Params params_of(model::QuantizationMethod method) {
  model::SensorModel sensor = model::find_model("mpu6500");
  sensor.quantization = model::Quantization{.step_rad_s = kStep_dps * kDps, .method = method};
  return {.model =
              model::make_node_model<kShape>(sensor, kPeriod, core::Duration::milliseconds(500))};
}

/// Mean error of the corrected rate on the move, of x, y and z [deg/s].
std::array<double, 3> mean_errors(const std::vector<Row>& rows, model::QuantizationMethod method) {
  const HandHeldNode::Params params = params_of(method);
  HandHeldNode node{params};
  std::array<double, 3> sum{};
  std::array<double, 3> count{};
  for (const Row& row : rows) {
    core::GyroSample sample{
        .time = core::Instant::from_ns(static_cast<std::int64_t>(std::llround(row.time_s * 1e9)))};
    for (std::size_t i = 0; i < 3; ++i) {
      sample.rate[i] = core::rad_per_s(static_cast<float>(row.rate_dps[i] * kDps));
    }
    if (!row.is_still) node.pulse(sample.time);
    const app::RateMessage message = node.step(sample);
    if (row.is_still || !message.health.calibrated) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      if (std::isnan(row.reference_dps[i])) continue;
      sum[i] += double{message.axes[i].corrected.in(core::deg_per_s)} - row.reference_dps[i];
      count[i] += 1.0;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) sum[i] /= count[i];
  std::printf("%s: %.4f %.4f %.4f deg/s over %.0f samples\n",
              method == model::QuantizationMethod::truncation ? "undone" : "as read", sum[0],
              sum[1], sum[2], count[0]);
  return sum;
}

TEST(SensorMovedByHand, KeepsItsBiasOnTheMoveWhereTheCutIsUndone) {
  const auto folder = zerorate::testing::find_recordings(ZERORATE_REPOSITORY);
  if (!folder) GTEST_SKIP() << "skipped: no recordings";
  const auto rows =
      read_rows(*folder / "broad_hand/broad_14_undisturbed_slow_translation_with_breaks_B.csv.gz");
  const auto as_read = mean_errors(rows, model::QuantizationMethod::rounding);
  const auto undone = mean_errors(rows, model::QuantizationMethod::truncation);
  constexpr std::array<double, 3> kMost_dps{0.030, 0.020, 0.015};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(std::abs(undone[i]), kMost_dps[i]) << i;
    EXPECT_LT(std::abs(undone[i]), std::abs(as_read[i])) << i;
  }
}

}  // namespace
}  // namespace zerorate::scenario
