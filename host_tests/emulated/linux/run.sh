#!/usr/bin/env bash
# run.sh REPOSITORY WORK_FOLDER SECONDS ZERORATE PRESET
#
# The zerorated of a preset (linux-arm64, linux-arm64-gpiod2, linux-armhf), out of its Debian package, on Debian's
# own arm64 kernel under QEMU, in virtual time. Kernel modules of ours (GPL-2.0, for tests only) give it a real SPI
# controller and a real GPIO chip; a process in the same machine plays the gyro and the odometer, breaks them, and
# judges what zerorated publishes. What was measured is then replayed here, and everything is done twice: both runs
# must print the same, to the last byte. Kernel, headers and busybox come from Debian, newest version, once; where
# Debian cannot be reached the test fails.
set -euo pipefail
repository=$(readlink -f "$1")
work=$2
seconds=$3
zerorate=$(readlink -f "$4") # of this machine, for the replay
preset=$5
source "$repository/host_tests/emulated/linux/machine.sh"

# boot NAME: one run; all of its console goes to NAME.txt, of which the findings are NAME.log and the recording is
# NAME.csv.gz.
boot() {
  "${qemu[@]}" </dev/null | stdbuf -oL tr -d '\r' >"$out/$1.txt"
  sed -n '/^RECORDING$/,/^END$/{//!p}' "$out/$1.txt" | base64 -d >"$out/$1.csv.gz"
  sed '/^RECORDING$/,$d' "$out/$1.txt" >"$out/$1.log"
  cat "$out/$1.log"
}

fetch
build zerorate_world
build_modules
# shellcheck disable=SC2046 # a list of files
pack zerorate_world "zerorate_world node $seconds
echo RECORDING
gzip -9 -c /run/recording.csv | base64
echo END
poweroff -f" $(module_files i2c-dev vcan can-raw) "${our_modules[@]}"
take_turns
boot first
grep -q '^WORLD [0-9]* passed, 0 failed$' "$out/first.log"
grep -q '^/etc/zerorate/zerorated.toml: valid$' "$out/first.log"
"$zerorate" replay "$out/first.csv.gz" --model lsm6dso --filter-rate 2 --settle 1.006 --sample-rate 104 --out "$out/replayed.csv" >"$out/replay.log"
python3 -B "$here/compare_replay.py" "$out/first.csv.gz" "$out/replayed.csv"
boot second >/dev/null
diff "$out/first.txt" "$out/second.txt" >"$out/differences" || { head -n 20 "$out/differences"; exit 1; }
echo "a second run wrote the same, byte for byte: $(wc -c <"$out/first.txt") bytes, the recording among them"
