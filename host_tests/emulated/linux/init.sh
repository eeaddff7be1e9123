#!/bin/busybox sh
# The first process of the emulated machine.
/bin/busybox --install -s /bin
export PATH=/bin:/usr/sbin
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

zerorate_world /zerorated.toml /run/rate.sock @SECONDS@ >/run/world.log &
world=$!
until grep -q '^WORLD ready' /run/world.log; do sleep 0.1; done
zerorated --config /zerorated.toml 2>/run/zerorated.log &
node=$!
until grep -q '^PULSES' /run/world.log; do sleep 0.1; done
sleep 2 # the metrics are a second old; the world gives no pulses meanwhile
grep '^zerorate_pulses_total ' /run/metrics | sed 's/^/AFTER_DRIVES /'
grep -E '^zerorate_(samples_total|pulses_lost_total|queue_dropped_total|sink_(sent|dropped)_total.*) ' /run/metrics
grep -E '^Vm(HWM|RSS|Lck)' /proc/$node/status
wait $world
kill -TERM $node
wait $node
echo "zerorated ended with $?"
cat /run/world.log /run/zerorated.log
ls -l /run/state
poweroff -f
