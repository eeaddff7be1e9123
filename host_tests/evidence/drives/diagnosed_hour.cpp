#include "host_tests/evidence/drives/diagnosed_hour.hpp"

#include "firmware/model/catalogue.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lib/diagnose/drive/drive_diagnosis.hpp"
#include "host_tools/lib/recording/writer.hpp"
#include "host_tools/lib/simulate/streets.hpp"

namespace zerorate::diagnose {

simulate::ScenarioDrive made_hour(std::uint64_t seed, const HourOptions& options) {
  constexpr double kPeriod_s = 0.04;
  // Grades of 3 %: those of 10 % take 0.5 % off a turn about z.
  const simulate::StreetParams streets{.duration_s = options.length_s,
                                       .mean_stop_s = 40.0,
                                       .manoeuvres_per_drive = 5.0,
                                       .least_grade = 0.03,
                                       .most_grade = 0.03};
  const auto motion =
      simulate::follow(drive_in_streets(streets, random::RandomStream{seed}), kPeriod_s);
  simulate::ScenarioDrive drive = record(motion, {.errors = options.errors}, seed);
  drive.columns.acceleration = true;
  if (options.per_g_rad_s == 0.0) return drive;
  for (std::size_t k = 0; k < drive.rows.size(); ++k) {
    const auto& force_g = motion.force_g[k];
    drive.rows[k].row.rate_rad_s[2] +=
        static_cast<float>(options.per_g_rad_s * (force_g[0] + force_g[1] + force_g[2] - 1.0));
  }
  return drive;
}

DriveDiagnosis diagnosis_of(const simulate::ScenarioDrive& drive) {
  const zerorate::testing::ScratchFolder folder;
  const recording::Input input{folder.path() / "hour.csv"};
  recording::Writer writer{input.path, drive.columns};
  for (const simulate::ScenarioRow& row : drive.rows) writer.write(row.row);
  writer.finish();
  recording::Reader reader{input};
  const truth::Track track = truth::read_track(reader);
  model::SensorModel model = model::find_model("lsm6dso");
  const truth::Truth truth = truth::find_truth(track, {});
  return diagnose_drives(read_drive_record(input, track, truth, model), model);
}

}  // namespace zerorate::diagnose
