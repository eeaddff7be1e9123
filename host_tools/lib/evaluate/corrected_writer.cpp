#include "host_tools/lib/evaluate/corrected_writer.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <iterator>

#include "core/base/numeric.hpp"
#include "firmware/wire/health_bits.hpp"

namespace zerorate::evaluate {
namespace {

constexpr std::size_t kFlushAt = std::size_t{1} << 16U;

}  // namespace

CorrectedWriter::CorrectedWriter(const std::filesystem::path& path, std::size_t axis_count)
    : file_(path), axis_count_(axis_count) {
  auto out = std::back_inserter(text_);
  fmt::format_to(out, "t_s");
  for (std::size_t i = 0; i < axis_count_; ++i) {
    const std::string axis = axis_count_ == 1 ? "rate" : fmt::format("g{}", "xyz"[i]);
    fmt::format_to(out, ",{0}_dps,{0}_bias_dps,{0}_sigma_dps,{0}_turn_deg,{0}_turn_sigma_deg",
                   axis);
  }
  fmt::format_to(out,
                 ",turn_s,heading_deg,heading_sigma_deg,up_x,up_y,up_z,motion,usable,health\n");
}

void CorrectedWriter::write(const ReplayedSample& sample) {
  auto out = std::back_inserter(text_);
  const std::int64_t ns = sample.time_ns;
  fmt::format_to(out, "{}{}.{:09}", ns < 0 ? "-" : "", std::abs(ns / 1'000'000'000),
                 std::abs(ns % 1'000'000'000));
  const auto cell = [&](bool known, float value) {
    text_.push_back(',');
    if (known) fmt::format_to(out, "{:.7g}", value);
  };
  for (std::size_t i = 0; i < axis_count_; ++i) {
    const app::AxisRate& axis = sample.message.axes[i];
    const bool has_bias = sample.message.health.calibrated;
    cell(sample.message.has_rate(), axis.corrected.in(core::deg_per_s));
    cell(has_bias, axis.bias.in(core::deg_per_s));
    cell(has_bias, axis.sigma.in(core::deg_per_s));
    const app::AxisTurn& turn = sample.message.turn[i];
    const bool has_turn = core::is_finite(turn.sigma.in(core::deg));
    cell(has_turn, turn.angle.in(core::deg));
    cell(has_turn, turn.sigma.in(core::deg));
  }
  fmt::format_to(out, ",{:.3f}", sample.message.turn_time.in_seconds());
  const float heading_sigma_deg = sample.message.heading.sigma.in(core::deg);
  const bool has_heading = core::is_finite(heading_sigma_deg);
  cell(has_heading, sample.message.heading.angle.in(core::deg));
  cell(has_heading, heading_sigma_deg);
  const auto& up = sample.message.up;
  for (const float share : up.value_or(core::Direction{})) cell(up.has_value(), share);
  fmt::format_to(out, ",{},{:d},", core::name(sample.message.motion),
                 sample.message.health.is_usable());
  append_flags(sample.message.health);
  text_.push_back('\n');
  if (text_.size() >= kFlushAt) flush();
}

void CorrectedWriter::append_flags(const app::Health& health) {
  const std::size_t begin = text_.size();
  for (const wire::HealthBit& bit : wire::kHealthBits) {
    if (!(health.*bit.flag)) continue;
    if (text_.size() > begin) text_.push_back('|');
    text_.append(bit.name);
  }
}

void CorrectedWriter::finish() {
  flush();
  file_.finish();
}

void CorrectedWriter::flush() {
  file_.write(text_);
  text_.clear();
}

}  // namespace zerorate::evaluate
