#!/usr/bin/env bash
# stock.sh REPOSITORY WORK_FOLDER
#
# The arm64 zerorated on Debian's own kernel without a module of ours: spidev and i2c-dev are played by a process
# through CUSE, the lines are those of QEMU's PL061, driven from outside (stock_machine.py). A smaller test than
# run.sh, of kernel interfaces that none of our modules could have got wrong.
set -euo pipefail
repository=$(readlink -f "$1")
work=$2
preset=linux-arm64
source "$repository/host_tests/emulated/linux/machine.sh"
out="$work/stock"
mkdir -p "$out"

fetch
build zerorate_stock_world
# The lines have no names.
# shellcheck disable=SC2046 # a list of files
pack zerorate_stock_world "sed -i -e s/gpiochip1/gpiochip0/ -e 's/\"GYRO_DRDY\"/0/' -e 's/\"ODOMETER\"/1/' /*.toml
zerorate_stock_world
poweroff -f" $(module_files cuse vcan can-raw)
machine # whose threads do not take turns: its processor computes while it waits for the lines
python3 -B "$here/stock_machine.py" "$out" "${qemu[@]}" | tee "$out/console.log"
grep -q '^WORLD [0-9]* passed, 0 failed$' "$out/console.log"
