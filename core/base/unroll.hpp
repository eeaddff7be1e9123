/// @file
/// Loops of constant length without a loop.
#pragma once

/// ZERORATE_UNROLLED for (...): asks the compiler to unroll the loop completely, which nested loops
/// over a triangle need before their indices become constants. Clang does so of its own accord;
/// where floating point is software it is half the code again for a twentieth of the time.
#if defined(__GNUC__) && !defined(__clang__) && !defined(__ARM_ARCH_6M__)
#define ZERORATE_UNROLLED _Pragma("GCC unroll 16")
#else
#define ZERORATE_UNROLLED
#endif
