#include "host_tests/evidence/drives/diagnosed_hour.hpp"

#include "firmware/model/catalogue.hpp"
#include "host_tests/support/folders.hpp"
#include "host_tools/lib/diagnose/drive/drive_diagnosis.hpp"
#include "host_tools/lib/recording/writer.hpp"

namespace zerorate::diagnose {

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
