#include "host_tools/lab/campaign/drive_recording.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "firmware/model/catalogue.hpp"
#include "host_tools/lab/campaign/drive_effects.hpp"
#include "host_tools/lib/diagnose/drive/evidence.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::campaign {
namespace {

using diagnose::DriveRecord;
using sizing::Draws;

/// A hidden effect of known size.
struct Sized {
  const SizedDriveEffect* effect = nullptr;
  double size = 0.0;
};

/// A file for the length of a block.
class ScratchFile {
 public:
  ScratchFile() {
    std::string name = (std::filesystem::temp_directory_path() / "zerorate-hour-XXXXXX").string();
    const int file = mkstemp(name.data());
    if (file >= 0) close(file);
    path_ = name + ".csv";
    std::filesystem::rename(name, path_);
  }
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Whole drives, by whose errors the size of an effect is stated.
DriveRecord record_of(const Hour& hour) {
  const ScratchFile file;
  write_drive(hour.drive, file.path());
  const recording::Input input{file.path()};
  recording::Reader reader{input};
  const truth::Track track = truth::read_track(reader);
  truth::Truth truth = truth::find_truth(track, {.vertical = truth::VerticalAxis{}});
  for (truth::Drive& drive : truth.drives) drive.flaw = truth::Flaw::none;
  return diagnose::whole_drives(
      diagnose::read_drive_record(input, track, truth, model::find_model("lsm6dso")));
}

Hour hour_with(std::uint64_t seed, HourOptions options, const std::vector<Sized>& hidden) {
  for (const Sized& one : hidden) {
    if (one.effect->make) one.effect->make(options, one.size);
  }
  Hour hour = make_hour(seed, options);
  for (const Sized& one : hidden) {
    if (one.effect->change) one.effect->change(hour, one.size);
  }
  return hour;
}

/// Columns of the catalogue: turn, path, time, metres and forces.
Eigen::MatrixXd catalogue_columns(const DriveRecord& record) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(record.size()), 7);
  for (std::size_t k = 0; k < record.size(); ++k) {
    const diagnose::DriveEvidence& drive = record.drives[k];
    columns.row(static_cast<Eigen::Index>(k)) << drive.turn_rad, drive.path_rad, drive.moving_s,
        drive.metres, drive.force_g_s[0], drive.force_g_s[1], drive.force_g_s[2];
  }
  return columns;
}

/// Log likelihood that a model without the effect loses, its variance as at rest. Of an effect from
/// outside the part counts that no combination of the catalogue's columns describes.
double loss_nats(const DriveRecord& without, const DriveRecord& with, bool is_outside) {
  const Eigen::MatrixXd lower = without.covariance().llt().matrixL();
  const auto whitened = [&](const Eigen::MatrixXd& columns) -> Eigen::MatrixXd {
    return lower.triangularView<Eigen::Lower>().solve(columns);
  };
  Eigen::VectorXd share = whitened(with.errors() - without.errors());
  if (is_outside) {
    const Eigen::MatrixXd columns = whitened(catalogue_columns(without));
    share -= columns * columns.colPivHouseholderQr().solve(share);
  }
  return 0.5 * share.squaredNorm();
}

/// The size at which the effect costs the nats.
double size_for(const SizedDriveEffect& effect, std::uint64_t seed, const HourOptions& options,
                double nats, bool is_outside) {
  const DriveRecord without = record_of(make_hour(seed, options));
  // One step is exact where the error is in proportion to the size.
  const int steps = effect.power == 1.0 ? 1 : 3;
  double size = effect.first;
  for (int i = 0; i < steps; ++i) {
    const DriveRecord with = record_of(hour_with(seed, options, {{&effect, size}}));
    size *= std::pow(nats / loss_nats(without, with, is_outside), 0.5 / effect.power);
  }
  return size;
}

/// Pulses that come in lumps: the train of gears has play.
void add_backlash(Hour& hour) {
  constexpr std::int64_t kPlay = 12;
  for (simulate::ScenarioRow& row : hour.drive.rows) {
    row.row.odometer_pulses -= row.row.odometer_pulses % kPlay;
  }
}

HourOptions draw_options(Draws& draws) {
  HourOptions options;
  options.streets.mean_stop_s = draws.uniform(25.0, 60.0);
  options.streets.manoeuvres_per_drive = draws.uniform(3.0, 7.0);
  options.streets.speed_m_s = draws.uniform(7.0, 13.0);
  return options;
}

/// Places of a round.
struct Place {
  Kind kind = Kind::clean;
  std::size_t number = 0;  ///< within the kind
};

Place place_of(std::size_t run) {
  const std::size_t singles = drive_effects().size() + drive_faults().size();
  const std::size_t place = run % kDriveRound;
  if (place < singles) return {Kind::single, place};
  if (place < singles + 4) return {Kind::clean, place - singles};
  if (place < singles + 7) return {Kind::pair, place - singles - 4};
  return {Kind::outside, place - singles - 7};
}

/// The effects of known size that a place hides.
std::vector<const SizedDriveEffect*> sized_at(const Place& place, std::size_t run) {
  const auto known = drive_effects();
  switch (place.kind) {
    case Kind::clean:
      return {};
    case Kind::single:
      if (place.number < known.size()) return {&known[place.number]};
      return {};
    case Kind::pair: {
      // The third pair of a round has a fault for its second effect.
      const std::size_t first = (run / kDriveRound + place.number) % known.size();
      if (place.number == 2) return {&known[first]};
      return {&known[first], &known[(first + 1 + place.number) % known.size()]};
    }
    case Kind::outside:
      return {&drive_effects_outside()[place.number]};
  }
  return {};
}

const DriveFault* fault_at(const Place& place, std::size_t run) {
  const auto faults = drive_faults();
  if (place.kind == Kind::single && place.number >= drive_effects().size()) {
    return &faults[place.number - drive_effects().size()];
  }
  if (place.kind == Kind::pair && place.number == 2) {
    // A full scale may leave too few drives for a second effect.
    return &faults[run / kDriveRound % (faults.size() - 1)];
  }
  return nullptr;
}

}  // namespace

BlindRecording draw_drive_recording(const BlindOptions& options, std::size_t run) {
  const auto stream = random::RandomStream(options.seed).substream(run);
  Draws draws{stream.substream("drives")};
  const HourOptions hour_options = draw_options(draws);
  const std::uint64_t seed = options.seed * 100'003 + run;
  const Place place = place_of(run);
  const bool is_outside = place.kind == Kind::outside;
  BlindRecording blind{.kind = place.kind, .signal = {0, 1.0}};
  std::vector<Sized> hidden;
  for (const SizedDriveEffect* effect : sized_at(place, run)) {
    const double sign = draws.sign();
    const double nats = options.nats * (is_outside ? options.outside_factor : 1.0);
    hidden.push_back({effect, size_for(*effect, seed, hour_options, nats, is_outside)});
    if (effect->power == 1.0) hidden.back().size *= sign;
    blind.truth.emplace_back(effect->name);
    const double figure = hidden.back().size / effect->unit;
    if (!effect->figure.empty())
      blind.figures[std::string(effect->name)][std::string(effect->figure)] = figure;
    blind.description += fmt::format("{} of {:.3g} ", effect->name, figure);
  }
  Hour hour = hour_with(seed, hour_options, hidden);
  if (const DriveFault* fault = fault_at(place, run)) {
    blind.description += fault->hide(hour, draws);
    blind.truth.emplace_back(fault->name);
  }
  if (place.kind == Kind::clean && place.number % 2 == 1) {
    add_backlash(hour);
    blind.description = "backlash of the odometer";
  }
  blind.drive = std::move(hour.drive);
  return blind;
}

}  // namespace zerorate::campaign
