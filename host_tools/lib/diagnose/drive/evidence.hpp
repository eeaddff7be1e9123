/// @file
/// Evidence of drives between true stops: errors of the heading with their variance, and what may
/// have caused them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/drive/bias_process.hpp"
#include "host_tools/lib/diagnose/drive/trace_effect.hpp"
#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/evaluate/true_drives.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/truth/track.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::diagnose {

/// One drive. The bias and what its inputs are at rest are taken off: they are interpolated between
/// the measurements at all stops.
struct DriveEvidence {
  double departure_s = 0.0;
  double length_s = 0.0;
  /// Turn about the vertical axis less that of the reference, of which an axis misses a small share
  double error_rad = 0.0;
  double turn_rad = 0.0;  ///< turn of the reference
  double path_rad = 0.0;  ///< sum of the sizes of its parts
  double moving_s = 0.0;
  double metres = 0.0;
  std::array<double, 3> turned_rad{};  ///< turns about x, y and z of the sensor
  /// Integral of the specific force less that at rest, x, y and z [g s]
  std::array<double, 3> force_g_s{};
  double vibration_g2_s = 0.0;  ///< integral of the vibration less that at rest
};

struct DriveRecord {
  truth::VerticalAxis vertical;
  std::size_t axis_count = 3;
  bool has_acceleration = false;
  double reference_sigma_rad = 0.0;  ///< standard deviation of a heading of the reference
  double way_sigma_rad = 0.0;  ///< standard deviation of what the reference errs by on each way
  std::vector<DriveEvidence> drives;
  std::vector<std::size_t> number;  ///< number of each drive, of which flawed ones are left out
  /// Covariance of the errors by noise and by the bias between its measurements [rad^2]
  Eigen::MatrixXd bias_rad2;
  std::size_t left_out = 0;            ///< drives with a flaw, or spoilt by a finding
  std::vector<TraceFinding> findings;  ///< found in the rows and in the reference of single drives
  std::string obstacle;                ///< reason why there are no drives; empty if there are

  [[nodiscard]] std::size_t size() const { return drives.size(); }
  /// Errors of all drives [rad].
  [[nodiscard]] Eigen::VectorXd errors() const;
  /// Covariance of the errors but for a factor. Drives share the measurements of the bias, and
  /// neighbours the reference's heading at a stop.
  [[nodiscard]] Eigen::MatrixXd covariance() const;
};

/// Collects the evidence of drives while a recording is replayed.
class EvidenceCollector {
 public:
  EvidenceCollector(const truth::Track& track, const truth::Truth& truth);

  void take(const evaluate::ReplayedSample& sample);
  /// @param drives of the same replay, whose node had no tolerance of the scale factor
  /// @param process that the bias follows, of each axis
  /// @param findings whose drives are left out
  [[nodiscard]] DriveRecord finish(const evaluate::TrueDrives& drives, const BiasProcess& process,
                                   std::vector<TraceFinding> findings) const;

 private:
  /// Sums over a drive, or over a part of a stop.
  struct Stretch {
    Span span;
    DriveEvidence sums;
  };

  [[nodiscard]] Stretch& part_of_stop(double time_s, double elapsed_s);
  void add_to_way(const evaluate::ReplayedSample& sample, double elapsed_s,
                  DriveEvidence& way) const;

  /// Takes what is alike at rest off the sums of the drives.
  void take_rest_off(const BiasProcess& process, const std::vector<Span>& drives,
                     DriveRecord& record) const;

  const truth::Track& track_;
  const truth::Truth& truth_;
  std::vector<Stretch> ways_;
  std::vector<Stretch> rests_;
  std::size_t next_ = 0;
  std::size_t stop_of_newest_rest_ = 0;  ///< number of the drive after it
  std::optional<std::int64_t> newest_ns_;
  bool has_acceleration_ = false;
};

/// Replays a recording through a node, and collects the evidence of its drives. The node has no
/// tolerance of the scale factor, because the errors show what there is.
/// Throws recording::Error, recording::DataError and std::invalid_argument as evaluate::replay().
[[nodiscard]] DriveRecord read_drive_record(const recording::Input& input,
                                            const truth::Track& track, const truth::Truth& truth,
                                            model::SensorModel model);

}  // namespace zerorate::diagnose
