#!/bin/busybox sh
# The first process of the emulated machine; what it does is appended.
/bin/busybox --install -s /bin
export PATH=/bin:/usr/sbin:/usr/bin
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev
mount -t tmpfs run /run
while read -r module; do insmod "/modules/$module" || echo "FAILED: insmod $module"; done </modules/order
ip link set lo up
ip link add vcan0 type vcan
ip link set vcan0 up
mkdir /run/state
zerorated --check-config
