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
seconds=$3
zerorate=$(readlink -f "$4") # of this machine, for the replay
here="$repository/host_tests/emulated/linux"
mkdir -p "$2"
work=$(readlink -f "$2")
preset=$5
cross="$repository/build/$preset"
out="$work/$preset"
mkdir -p "$out"
source "$repository/toolchains/private-apt.sh"

fetch() {
  private_apt_root arm64 "$work/apt-arm64"
  private_apt_root amd64 "$work/apt-amd64"
  local image
  image=$(APT_CONFIG="$work/apt-arm64/apt.conf" apt-cache show --no-all-versions linux-image-arm64 |
    sed -n 's/^Depends: \(linux-image-[^ ]*\) .*/\1/p')
  version=${image#linux-image-}
  if [[ -e "$work/fetched-$version" ]]; then return; fi
  rm -rf "$work"/{debs,kernel,headers,target}
  private_apt_download "$work/apt-arm64" "$work/debs" "$image" "linux-headers-$version" \
    "linux-headers-${version%-arm64}-common" busybox-static
  private_apt_download "$work/apt-amd64" "$work/debs" "linux-kbuild-$(cut -d. -f1,2 <<<"$version")"
  mkdir -p "$work"/{kernel,headers,target}
  dpkg-deb -x "$work/debs/${image}"_*.deb "$work/kernel"
  depmod -b "$work/kernel" "$version"
  for deb in "$work"/debs/linux-{headers,kbuild}-*.deb; do dpkg-deb -x "$deb" "$work/headers"; done
  for deb in "$work"/debs/busybox*.deb; do dpkg-deb -x "$deb" "$work/target"; done
  sed -i "s# /usr/src/# $work/headers/usr/src/#" "$work/headers/usr/src/linux-headers-$version/Makefile"
  touch "$work/fetched-$version"
}

build() {
  (cd "$repository" && cmake --preset "$preset" && cmake --build "$cross" --target zerorated zerorate zerorate_c zerorate_world &&
    cd "$cross" && cpack) >"$out/build.log"
  rm -rf "$out/modules"
  cp -r "$here/kernel" "$out/modules"
  ZERORATE_REPOSITORY="$repository" DEB_BUILD_ARCH=amd64 DEB_HOST_ARCH=arm64 DEB_HOST_GNU_TYPE=aarch64-linux-gnu \
    make -s -C "$work/headers/usr/src/linux-headers-$version" M="$out/modules" modules >>"$out/build.log" 2>&1
}

# The modules that `modprobe NAME...` would load, in order, one path a line.
module_files() {
  local name
  for name in "$@"; do
    modprobe -d "$work/kernel" -S "$version" --show-depends "$name"
  done | awk '$1 == "insmod" && !seen[$2]++ {print $2}'
}

pack() {
  local root="$out/root" sysroot libraries file
  sysroot=$(sed -n 's/^ZERORATE_SYSROOT:.*=//p' "$cross/CMakeCache.txt")
  libraries=$(echo "$sysroot"/usr/lib/*-linux-gnu*) # that of the package's architecture
  rm -rf "$root"
  mkdir -p "$root"/{bin,dev,lib,modules,proc,run,sys}
  cp "$work/target/bin/busybox" "$root/bin/"
  dpkg-deb -x "$cross"/zerorate_*.deb "$root"
  cp "$cross/host_tests/emulated/linux/guest/zerorate_world" "$root/bin/"
  cp -L "/usr/$(basename "$libraries")"/lib/{ld-linux-*.so.?,libc.so.6,libm.so.6,libgcc_s.so.1,libstdc++.so.6} "$root/lib/"
  # The one that zerorated was linked to, under the name that it asks for.
  file=$(readelf -d "$root/usr/sbin/zerorated" | sed -n 's/.*\[\(libgpiod[^]]*\)\]/\1/p')
  cp -L "$libraries/$file" "$root/lib/"
  for file in $(module_files i2c-dev vcan can-raw) "$out"/modules/zerorate_{bus,lines}.ko; do
    cp "$file" "$root/modules/"
    basename "$file" >>"$root/modules/order"
  done
  cp "$here/zerorated.toml" "$root/"
  sed "s/@SECONDS@/$seconds/" "$here/init.sh" >"$root/init"
  chmod +x "$root/init"
  (cd "$root" && find . | LC_ALL=C sort | cpio --quiet -o -H newc | gzip -1) >"$out/initramfs.gz"
}

# boot NAME: one run; all of its console goes to NAME.txt, of which the findings are NAME.log and the recording is
# NAME.csv.gz. Time counts instructions, and what the kernel draws at random (its own place, those of stacks and
# libraries) begins with a seed that is always the same. QEMU's main thread moves time on when the processor sleeps;
# at the same moment as the processor's thread, it may do so before the last instructions are counted. On one
# processor, and not preempted for each other, the two take turns.
boot() {
  local processor
  processor=$(taskset --cpu-list --pid $$ | sed 's/.*[^0-9]//')
  timeout 900 chrt --batch 0 taskset --cpu-list "$processor" \
    qemu-system-aarch64 -M virt -cpu cortex-a53 -m 256 -nographic -nic none -no-reboot \
    -icount shift=1,sleep=off -rtc base=2026-01-01,clock=vm -seed 1 \
    -kernel "$work/kernel/boot/vmlinuz-$version" -initrd "$out/initramfs.gz" \
    -append "console=ttyAMA0 quiet panic=-1 nokaslr" </dev/null | stdbuf -oL tr -d '\r' >"$out/$1.txt"
  sed -n '/^RECORDING$/,/^END$/{//!p}' "$out/$1.txt" | base64 -d >"$out/$1.csv.gz"
  sed '/^RECORDING$/,$d' "$out/$1.txt" >"$out/$1.log"
  cat "$out/$1.log"
}

fetch
build
pack
boot first
grep -q '^WORLD [0-9]* passed, 0 failed$' "$out/first.log"
grep -q '^/etc/zerorate/zerorated.toml: valid$' "$out/first.log"
"$zerorate" replay "$out/first.csv.gz" --model lsm6dso --filter-rate 2 --out "$out/replayed.csv" >"$out/replay.log"
python3 -B "$here/compare_replay.py" "$out/first.csv.gz" "$out/replayed.csv"
boot second >/dev/null
diff "$out/first.txt" "$out/second.txt" >"$out/differences" || { head -n 20 "$out/differences"; exit 1; }
echo "a second run wrote the same, byte for byte: $(wc -c <"$out/first.txt") bytes, the recording among them"
