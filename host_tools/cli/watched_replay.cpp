#include "host_tools/cli/watched_replay.hpp"

#include <utility>

#include "host_tools/cli/terminal.hpp"

namespace zerorate::cli {

evaluate::ReplayResult replay_watched(recording::Reader& reader,
                                      const evaluate::ReplayOptions& options,
                                      const ReplaySinks& sinks, evaluate::TrueRate true_rate,
                                      std::optional<truth::Truth> truth) {
  evaluate::ReplayObserver observer{.true_rate = std::move(true_rate), .truth = std::move(truth)};
  if (sinks.trace != nullptr || sinks.corrected != nullptr) {
    observer.on_sample = [&](const evaluate::ReplayedSample& sample) {
      if (sinks.corrected != nullptr) sinks.corrected->write(sample);
      if (sinks.trace != nullptr) sinks.trace->add(sample);
    };
  }
  if (sinks.trace != nullptr) {
    observer.on_drive = [&](const evaluate::ReplayedDrive& drive) { sinks.trace->add(drive); };
    observer.on_learnt = [&](const evaluate::LearntStop& stop) { sinks.trace->add(stop); };
  }
  ProgressBar progress{"replaying"};
  observer.on_progress = [&](std::optional<double> share) { progress.update(share); };
  evaluate::ReplayResult result = evaluate::replay(reader, options, observer);
  if (sinks.corrected != nullptr) sinks.corrected->finish();
  if (sinks.trace != nullptr) sinks.trace->finish();
  return result;
}

}  // namespace zerorate::cli
