/// @file
/// Evidence of drives between true stops, collected in a replay.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/model/sensor_model.hpp"
#include "host_tools/lib/diagnose/drive/bias_process.hpp"
#include "host_tools/lib/diagnose/drive/drive_record.hpp"
#include "host_tools/lib/diagnose/drive/trace_effect.hpp"
#include "host_tools/lib/evaluate/replay.hpp"
#include "host_tools/lib/evaluate/true_drives.hpp"
#include "host_tools/lib/recording/reader.hpp"
#include "host_tools/lib/truth/track.hpp"
#include "host_tools/lib/truth/truth.hpp"

namespace zerorate::diagnose {

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
  /// Sums over a window, or over a part of a stop.
  struct Stretch {
    Span span;
    DriveEvidence sums;
  };
  /// A drive in windows.
  struct Way {
    std::vector<std::int64_t> cuts_ns;  ///< times between the windows
    std::vector<Stretch> windows;       ///< one more
    std::size_t newest = 0;
  };

  /// Straight moments of a drive.
  [[nodiscard]] std::vector<std::int64_t> cuts_of(const truth::Drive& drive) const;
  [[nodiscard]] static Stretch& window_at(std::int64_t time_ns, Way& way);
  [[nodiscard]] Stretch& part_of_stop(double time_s, double elapsed_s);
  void add_to_way(const evaluate::ReplayedSample& sample, double elapsed_s,
                  DriveEvidence& way) const;
  /// Turns of the reference in all windows of a drive; none where a heading is missing.
  [[nodiscard]] std::vector<double> turns_of(const truth::Drive& drive,
                                             const std::vector<std::int64_t>& cuts_ns) const;
  /// Windows with what the reference measured; one, the whole drive, where it or the rows have a
  /// gap.
  [[nodiscard]] std::vector<Stretch> windows_of(const truth::Drive& drive, const Way& way) const;

  /// Takes what is alike at rest off the sums of windows.
  /// @return covariance of their errors by noise and bias
  [[nodiscard]] Eigen::MatrixXd take_rest_off(const BiasProcess& process,
                                              const std::vector<Stretch>& rests,
                                              std::vector<Stretch>& windows) const;

  const truth::Track& track_;
  const truth::Truth& truth_;
  std::int64_t longest_speed_ns_;
  std::vector<Way> ways_;
  std::vector<Stretch> rests_;
  std::size_t next_ = 0;
  std::size_t stop_of_newest_rest_ = 0;  ///< number of the drive after it
  std::optional<std::int64_t> newest_ns_;
  bool has_acceleration_ = false;
};

/// Replays a recording through a node, and collects the evidence of its drives. The node has no
/// tolerance of the scale factor, because the errors show what there is. First the delay of the
/// reference is taken off, where one is found.
/// Throws recording::Error, recording::DataError and std::invalid_argument as evaluate::replay().
[[nodiscard]] DriveRecord read_drive_record(const recording::Input& input,
                                            const truth::Track& track, const truth::Truth& given,
                                            model::SensorModel model);

}  // namespace zerorate::diagnose
