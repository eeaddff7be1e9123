#!/bin/busybox sh
# The first process of the emulated machine.
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

zerorate_world @SECONDS@
echo RECORDING
gzip -9 -c /run/recording.csv | base64
echo END
poweroff -f
