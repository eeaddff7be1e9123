#include "host_tools/lib/identify/innovations_likelihood.hpp"

#include "firmware/app/tick_node.hpp"
#include "firmware/model/node_model.hpp"
#include "host_tools/lib/recording/error.hpp"
#include "host_tools/lib/statistics/statistics.hpp"

namespace zerorate::identify {
namespace {

constexpr core::ModelShape kLargestWithoutInputs{.decaying = model::kLargestShape.decaying,
                                                 .rotating = model::kLargestShape.rotating};

}  // namespace

InnovationsLikelihood::InnovationsLikelihood(std::span<const TickMean> ticks, std::size_t axis,
                                             core::Duration sample_period, core::Duration tick)
    : sample_period_(sample_period), tick_(tick) {
  if (ticks.size() < 2) throw recording::DataError("a likelihood needs at least two ticks");
  ticks_.reserve(ticks.size());
  for (const TickMean& mean : ticks) {
    ticks_.push_back({.tick = mean.tick,
                      .samples = mean.samples,
                      .end = {},
                      .rate_rad_s = {mean.rate_rad_s[axis]}});
  }
}

template <class Take>
void InnovationsLikelihood::for_each_innovation(const model::SensorModel& model, Take take) const {
  model::with_shape_of<kLargestWithoutInputs>(model, false, [&]<core::ModelShape Shape>() {
    using Node = app::TickNode<Shape, app::kFilterAlone>;
    const app::NodeParams<Shape> params{
        .model = model::make_node_model<Shape>(model, sample_period_, tick_),
        .learns_white_noise = false};
    Node node{params};
    for (const core::TickMean<1>& mean : ticks_) {
      const core::Innovation& innovation = node.learn_at_once({mean, false, {}, {}})[0];
      if (innovation.first) continue;
      take(TickInnovation{double{innovation.residual_rad_s}, double{innovation.variance_rad2_s2}});
    }
  });
}

Likelihood InnovationsLikelihood::operator()(const model::SensorModel& model) const {
  Likelihood likelihood;
  statistics::SumOfLogs log_variances;
  for_each_innovation(model, [&](const TickInnovation& innovation) {
    const double residual = innovation.residual_rad_s;
    log_variances.add(innovation.variance_rad2_s2);
    likelihood.squared_innovations += residual * residual / innovation.variance_rad2_s2;
    ++likelihood.innovations;
  });
  likelihood.log_variances = log_variances.value();
  return likelihood;
}

std::vector<TickInnovation> InnovationsLikelihood::innovations(
    const model::SensorModel& model) const {
  std::vector<TickInnovation> all;
  all.reserve(ticks_.size());
  for_each_innovation(model, [&](const TickInnovation& innovation) { all.push_back(innovation); });
  return all;
}

}  // namespace zerorate::identify
