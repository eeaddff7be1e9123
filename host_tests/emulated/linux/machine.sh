# Sourced: the emulated machine, after `repository`, `work` and `preset` are set. Kernel, headers and busybox come from
# Debian, newest version, once.
here="$repository/host_tests/emulated/linux"
mkdir -p "$work"
work=$(readlink -f "$work")
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

# build WORLD: the packages, and the program that plays the devices. What goes wrong is shown.
build() {
  (cd "$repository" && cmake --preset "$preset" && cmake --build "$cross" --target zerorated zerorate zerorate_c_objects "$1" &&
    cd "$cross" && cpack) >"$out/build.log" || { tail -n 40 "$out/build.log" && return 1; }
}

# Those in kernel/, and `our_modules`, in the order of their loading.
build_modules() {
  rm -rf "$out/modules"
  cp -r "$here/kernel" "$out/modules"
  ZERORATE_REPOSITORY="$repository" DEB_BUILD_ARCH=amd64 DEB_HOST_ARCH=arm64 DEB_HOST_GNU_TYPE=aarch64-linux-gnu \
    make -s -C "$work/headers/usr/src/linux-headers-$version" M="$out/modules" modules >>"$out/build.log" 2>&1
  our_modules=("$out"/modules/zerorate_{lines,bus}.ko)
}

# The modules that `modprobe NAME...` would load, in order, one path a line.
module_files() {
  local name
  for name in "$@"; do
    modprobe -d "$work/kernel" -S "$version" --show-depends "$name"
  done | awk '$1 == "insmod" && !seen[$2]++ {print $2}'
}

# The first process of the machine; what it does is appended.
first_process() {
  cat <<'EOF'
#!/bin/busybox sh
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
EOF
}

# pack WORLD INIT MODULE...: the initramfs, with modules by their files, in the order of their loading.
pack() {
  local root="$out/root" world=$1 init=$2 sysroot libraries file
  shift 2
  sysroot=$(sed -n 's/^ZERORATE_SYSROOT:.*=//p' "$cross/CMakeCache.txt")
  libraries=$(echo "$sysroot"/usr/lib/*-linux-gnu*) # that of the package's architecture
  rm -rf "$root"
  mkdir -p "$root"/{bin,dev,lib,modules,proc,run,sys}
  cp "$work/target/bin/busybox" "$root/bin/"
  dpkg-deb -x "$cross"/zerorate_*.deb "$root"
  cp "$cross/host_tests/emulated/linux/guest/$world" "$root/bin/"
  cp -L "/usr/$(basename "$libraries")"/lib/{ld-linux-*.so.?,libc.so.6,libm.so.6,libgcc_s.so.1,libstdc++.so.6} "$root/lib/"
  # The one that zerorated was linked to, under the name that it asks for.
  file=$(readelf -d "$root/usr/sbin/zerorated" | sed -n 's/.*\[\(libgpiod[^]]*\)\]/\1/p')
  cp -L "$libraries/$file" "$root/lib/"
  for file in "$@"; do
    cp "$file" "$root/modules/"
    basename "$file" >>"$root/modules/order"
  done
  cp "$here/zerorated.toml" "$root/"
  { first_process && printf '%s\n' "$init"; } >"$root/init"
  chmod +x "$root/init"
  (cd "$root" && find . | LC_ALL=C sort | cpio --quiet -o -H newc | gzip -1) >"$out/initramfs.gz"
}

# machine [COMMAND...]: the command that boots it, begun by another that says how QEMU is run. Time counts instructions,
# and what the kernel draws at random (its own place, those of stacks and libraries) begins with a seed that is always
# the same.
machine() {
  qemu=(timeout --kill-after=10 900 "$@"
    qemu-system-aarch64 -M virt -cpu cortex-a53 -m 256 -nographic -nic none -no-reboot
    -icount "shift=1,sleep=off" -rtc "base=2026-01-01,clock=vm" -seed 1
    -kernel "$work/kernel/boot/vmlinuz-$version" -initrd "$out/initramfs.gz"
    -append "console=ttyAMA0 quiet panic=-1 nokaslr")
}

# QEMU's main thread moves time on when the processor sleeps; if the processor's thread runs meanwhile, it may do so
# before the last instructions are counted. On one processor, and not preempted by anybody, the two take turns; without
# the right to that, nearly always.
take_turns() {
  local processor policy=(chrt --fifo 1)
  processor=$(taskset --cpu-list --pid $$ | sed 's/.*[^0-9]//')
  "${policy[@]}" true 2>/dev/null || policy=(chrt --batch 0)
  machine "${policy[@]}" taskset --cpu-list "$processor"
}
