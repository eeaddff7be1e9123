#include "host_tools/lib/statistics/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace zerorate::statistics {

BootstrapFigure bootstrap(std::size_t size, const Statistic& statistic,
                          const random::RandomStream& stream, const BootstrapParams& params) {
  std::vector<std::size_t> drawn(size);
  std::iota(drawn.begin(), drawn.end(), std::size_t{0});
  BootstrapFigure figure{.value = statistic(drawn)};
  if (std::isnan(figure.value)) return {};
  std::vector<double> values(params.draws);
  std::int64_t number = 0;
  for (double& value : values) {
    for (std::size_t i = 0; i < size; i += params.block) {
      const double place = stream.uniform(number++) * static_cast<double>(size);
      const auto first = static_cast<std::size_t>(place);
      for (std::size_t j = 0; j < params.block && i + j < size; ++j) {
        drawn[i + j] = (first + j) % size;
      }
    }
    value = statistic(drawn);
  }
  std::ranges::sort(values);
  figure.lo = values[params.draws / 40];
  figure.hi = values[params.draws - 1 - params.draws / 40];
  return figure;
}

}  // namespace zerorate::statistics
