/// @file
/// How surprising a gain of log likelihood is: -log of its probability by chance.
#pragma once

namespace zerorate::statistics {

/// A gain by `parameters` free amplitudes, 2 G ~ chi squared (Wilks).
[[nodiscard]] double surprisal_of_free(double gain_nats, double parameters);

/// A gain by one strength that cannot be negative: half of the time 0 (Self and Liang 1987).
[[nodiscard]] double surprisal_of_strength(double gain_nats);

/// The greatest gain over a searched parameter, which crosses a level upwards `crossings` e^(-G)
/// times on average (Davies 1987), beside the probability at a single place.
/// @param parameters of the amplitudes, 1 or 2
[[nodiscard]] double surprisal_of_search(double gain_nats, double parameters, double crossings);

}  // namespace zerorate::statistics
