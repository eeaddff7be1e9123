#include "host_tools/lab/campaign/drive_hour.hpp"

#include "host_tools/lib/random/random_stream.hpp"

namespace zerorate::campaign {

Hour make_hour(std::uint64_t seed, const HourOptions& options) {
  constexpr double kPeriod_s = 0.04;
  Hour hour;
  hour.motion = simulate::follow(
      simulate::drive_in_streets(options.streets, random::RandomStream{seed}), kPeriod_s);
  hour.drive = simulate::record(hour.motion, {.errors = options.errors}, seed);
  hour.drive.columns.acceleration = true;
  for (std::size_t k = 0; k < hour.drive.rows.size(); ++k) {
    const auto& force_g = hour.motion.force_g[k];
    const auto& along = options.per_g_rad_s;
    const double rate_rad_s =
        along[0] * force_g[0] + along[1] * force_g[1] + along[2] * (force_g[2] - 1.0);
    hour.drive.rows[k].row.rate_rad_s[2] += static_cast<float>(rate_rad_s);
  }
  return hour;
}

}  // namespace zerorate::campaign
