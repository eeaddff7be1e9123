#!/usr/bin/env python3
"""Exported models as C and as C++, converted back to the densities of the catalogue's figures.

usage: export_test.py ZERORATE [unittest arguments]
"""

import cmath
import math
import re
import subprocess
import sys
import tomllib
import unittest

ZERORATE = sys.argv.pop(1)
SAMPLE_RATE_HZ = 100.0
# The lags have a ripple about flicker noise (docs/design/identification.md, "From the filter to the noise").
RIPPLE = 0.06


def answer(*arguments):
    return subprocess.run([ZERORATE, *arguments], capture_output=True, text=True, timeout=60, check=True).stdout


def number(source, key):
    """The last of that name: the walk of C++ stands in a structure of its own."""
    return float(re.findall(rf"{key} = (?:INT64_C|core::Duration::nanoseconds)?\(?([-+.e0-9]+)", source)[-1])


class Source:
    """Noise of a header: white noise of a sample, a walk, and lags that the ticks excite."""

    def __init__(self, source, language):
        self.tick_s = number(source, "tick" if language == "--cpp" else "tick_ns") * 1e-9
        self.period_s = number(source, "sample_period" if language == "--cpp" else "sample_period_ns") * 1e-9
        self.white = number(source, "white_variance_rad2_s2")
        self.walk = number(source, "walk_variance" if language == "--cpp" else "walk_variance_rad2_s2")
        lags = re.findall(r"\.one_minus_phi = ([-+.e0-9]+)F, \.noise_variance = ([-+.e0-9]+)F", source)
        self.lags = [tuple(map(float, lag)) for lag in lags]

    def density(self, f):
        """Two-sided density of the means over ticks [(rad/s)^2/Hz]."""
        back = cmath.exp(-2j * math.pi * f * self.tick_s)
        slow = sum(noise / abs(1.0 - (1.0 - forgets) * back)**2 for forgets, noise in self.lags)
        return self.white * self.period_s + self.tick_s * (slow + self.walk / abs(1.0 - back)**2)


def density_of(model, f, tick_s):
    white = math.radians(model["white"]["angle_random_walk_dps_per_sqrt_hz"])
    flicker = model.get("flicker")
    if not flicker:
        return white**2
    strength = math.radians(flicker["bias_instability_dph"] / 3600.0)
    return white**2 + strength**2 * (2.0 * math.sin(math.pi * f * tick_s) / tick_s)**(-2.0 * flicker["order"])


class Export(unittest.TestCase):
    def test_holds_the_noise_of_every_model_of_the_catalogue(self):
        names = [line.split()[0] for line in answer("model", "list").splitlines() if line.strip()]
        self.assertGreater(len(names), 25)
        for name in names:
            model = tomllib.loads(answer("model", "show", name))
            for language in ("--c", "--cpp"):
                header = answer("export", name, language, "--hypotheses", "1", "--sample-rate", str(SAMPLE_RATE_HZ))
                source = Source(header, language)
                self.assertAlmostEqual(source.period_s, 1.0 / SAMPLE_RATE_HZ)
                self.assertGreaterEqual(len(source.lags), 4 if "flicker" in model else 0)
                for f in (1e-4, 1e-3, 1e-2, 0.05, 0.2):
                    ratio = source.density(f) / density_of(model, f, source.tick_s)
                    with self.subTest(model=name, language=language, frequency=f):
                        self.assertAlmostEqual(ratio, 1.0, delta=RIPPLE)


if __name__ == "__main__":
    unittest.main()
