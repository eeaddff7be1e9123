/// @file
/// Four floats that a processor with short vectors computes with at once. The same bits everywhere:
/// each lane is rounded as a float on its own.
#pragma once

namespace zerorate::core {

#if defined(__SSE2__) || defined(__aarch64__)

using Lanes = float __attribute__((vector_size(16)));

[[gnu::always_inline]] inline Lanes load_lanes(const float* from) {
  Lanes x;
  __builtin_memcpy(&x, from, sizeof x);
  return x;
}
[[gnu::always_inline]] inline void store_lanes(Lanes x, float* to) {
  __builtin_memcpy(to, &x, sizeof x);
}
/// Two floats, twice: (x0, x1, x0, x1). One access, since a processor is slow to load what it has
/// just stored in other pieces; compilers left to themselves choose such pieces.
[[gnu::always_inline]] inline Lanes load_pair_twice(const float* from) {
  float __attribute__((vector_size(8))) x;
  __builtin_memcpy(&x, from, sizeof x);
  return __builtin_shufflevector(x, x, 0, 1, 0, 1);
}
/// The first two lanes.
[[gnu::always_inline]] inline void store_pair(Lanes x, float* to) {
  __builtin_memcpy(to, &x, 2 * sizeof(float));
}
/// The lanes a, b, c, d of x.
template <int a, int b, int c, int d>
[[gnu::always_inline]] inline Lanes picked(Lanes x) {
  return __builtin_shufflevector(x, x, a, b, c, d);
}

#else

struct Lanes {
  float lane[4];

  [[gnu::always_inline]] float operator[](int i) const { return lane[i]; }
  [[gnu::always_inline]] friend Lanes operator+(Lanes x, Lanes y) {
    return {x[0] + y[0], x[1] + y[1], x[2] + y[2], x[3] + y[3]};
  }
  [[gnu::always_inline]] friend Lanes operator-(Lanes x, Lanes y) {
    return {x[0] - y[0], x[1] - y[1], x[2] - y[2], x[3] - y[3]};
  }
  [[gnu::always_inline]] friend Lanes operator*(Lanes x, Lanes y) {
    return {x[0] * y[0], x[1] * y[1], x[2] * y[2], x[3] * y[3]};
  }
};

[[gnu::always_inline]] inline Lanes load_lanes(const float* from) {
  return {from[0], from[1], from[2], from[3]};
}
[[gnu::always_inline]] inline void store_lanes(Lanes x, float* to) {
  to[0] = x[0];
  to[1] = x[1];
  to[2] = x[2];
  to[3] = x[3];
}
/// Two floats, twice: (x0, x1, x0, x1).
[[gnu::always_inline]] inline Lanes load_pair_twice(const float* from) {
  return {from[0], from[1], from[0], from[1]};
}
/// The first two lanes.
[[gnu::always_inline]] inline void store_pair(Lanes x, float* to) {
  to[0] = x[0];
  to[1] = x[1];
}
/// The lanes a, b, c, d of x.
template <int a, int b, int c, int d>
[[gnu::always_inline]] inline Lanes picked(Lanes x) {
  return {x[a], x[b], x[c], x[d]};
}

#endif

}  // namespace zerorate::core
