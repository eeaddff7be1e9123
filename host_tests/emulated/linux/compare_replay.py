#!/usr/bin/env python3
"""Compares what zerorated published on the emulated machine with a replay of what it measured.

usage: compare_replay.py RECORDING.csv.gz REPLAYED.csv

The recording carries the published bias and deviation beside the measured rates; the replay was written
by `zerorate replay --out`. Prints the largest differences; exit code 1 where one is too large.
"""

import csv
import gzip
import sys

# The replay prints seven digits; 1e-6 of the value is ten times that.
TOLERANCE = 1e-6


def main():
    recording, replayed = sys.argv[1:]
    with gzip.open(recording, "rt", encoding="ascii") as file:
        published = list(csv.DictReader(file))
    with open(replayed, encoding="ascii") as file:
        replay = list(csv.DictReader(file))
    if len(published) != len(replay):
        sys.exit(f"{len(published)} rows were published, {len(replay)} replayed")
    stops, was_still, largest, compared = 0, False, {"bias": 0.0, "sigma": 0.0}, 0
    for ours, theirs in zip(published, replay):
        still = theirs["motion"] == "still"
        stops += still and not was_still
        was_still = still
        for axis in "xyz":
            for figure in largest:
                text = theirs[f"g{axis}_{figure}_dps"]
                if text:
                    value = float(text)
                    difference = abs(float(ours[f"{figure}_{axis}"]) - value)
                    largest[figure] = max(largest[figure], difference / max(abs(value), 1e-3))
                    compared += 1
    print(f"{len(replay)} rows, {stops} stops, {compared} figures; largest relative difference of the bias "
          f"{largest['bias']:.2g}, of its deviation {largest['sigma']:.2g}")
    if compared == 0 or max(largest.values()) > TOLERANCE:
        sys.exit(1)


if __name__ == "__main__":
    main()
