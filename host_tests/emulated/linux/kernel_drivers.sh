#!/usr/bin/env bash
# kernel_drivers.sh REPOSITORY WORK_FOLDER short|long|relatives
#
# The kernel's own gyro drivers (IIO) on our simulated chips, behind the bus and the interrupt line of kernel/, and the
# arm64 zerorated on top: each chip once through our driver and once through the kernel's. Short: 8 s each, on a host
# that is busy with other tests. Long: 45 s each, stamps and the chips' relatives too (15 s each), twice, and the same
# must be printed. Relatives: these alone, once.
set -euo pipefail
repository=$(readlink -f "$1")
work=$2
case $3 in
  short) drives='drivers_on_busy_host 8' start=machine runs=1 ;;
  long) drives='drivers 45' start=take_turns runs=2 ;;
  relatives) drives='relatives 15' start=take_turns runs=1 ;;
esac
preset=linux-arm64
source "$repository/host_tests/emulated/linux/machine.sh"
show_kernel='dmesg | grep -E " (st_lsm6dsx|st-gyro|adxrs450|adis16475|bmg160|bmi160|inv-|iio)"'

# Some drivers know a chip, or its interrupt, by the device tree alone: to QEMU's own are added these chips, without
# address and bus, and the lines that their interrupt is one of. The modules in kernel/ look for both.
in_device_tree=(invensense,icm42605 bosch,bmi160 adi,adis16470 adi,adis16475-{1,2,3})
add_device_tree() {
  local tree="$out/virt.dtb" lines=/zerorate/lines gyro chip phandle=0x9000
  "${qemu[@]}" -machine "dumpdtb=$tree" </dev/null
  fdtput --create "$tree" /zerorate $lines
  fdtput --type s "$tree" $lines compatible zerorate,lines
  fdtput --type s "$tree" $lines interrupt-controller
  fdtput --type u "$tree" $lines '#interrupt-cells' 2
  fdtput --type x "$tree" $lines phandle $phandle
  for chip in "${in_device_tree[@]}"; do
    gyro=/zerorate/${chip#*,}
    fdtput --create "$tree" "$gyro"
    fdtput --type s "$tree" "$gyro" compatible "$chip"
    fdtput --type x "$tree" "$gyro" interrupt-parent $phandle
    fdtput --type u "$tree" "$gyro" interrupts 0 1 # line 0, rising
    fdtput --type s "$tree" "$gyro" interrupt-names INT1
  done
  qemu+=(-dtb "$tree")
}

fetch
build zerorate_world
build_modules
# shellcheck disable=SC2046 # a list of files
pack zerorate_world "zerorate_world $drives || cat /run/zerorated.log
$show_kernel
poweroff -f" $(module_files i2c-dev vcan can-raw st_lsm6dsx_spi st_lsm6dsx_i2c adxrs450 bmg160_spi \
  inv-mpu6050-spi inv-mpu6050-i2c inv-icm42600-spi inv-icm42600-i2c bmi160_spi bmi160_i2c st_gyro_spi st_gyro_i2c \
  adis16475) "${our_modules[@]}"
"$start"
add_device_tree
for ((run = 1; run <= runs; ++run)); do
  "${qemu[@]}" </dev/null | stdbuf -oL tr -d '\r' | tee "$out/drivers-$run.log"
  grep -q '^WORLD [0-9]* passed, 0 failed$' "$out/drivers-$run.log"
  diff "$out/drivers-1.log" "$out/drivers-$run.log"
done
