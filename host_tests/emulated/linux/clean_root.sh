#!/usr/bin/env bash
# clean_root.sh REPOSITORY WORK_FOLDER arm64|armhf|amd64
#
# Builds the node's Debian package for an architecture, lets apt find everything it depends on in Debian's
# archive, as on a machine that has nothing yet, unpacks all of it into an empty root, and runs the programs
# there: under qemu-user where this machine has another processor. The scripts of the package are not run.
set -euo pipefail
repository=$(readlink -f "$1")
mkdir -p "$2"
work=$(readlink -f "$2")
arch=$3
declare -A emulator=([arm64]=qemu-aarch64 [armhf]=qemu-arm [amd64]=)
declare -A triplet=([arm64]=aarch64-linux-gnu [armhf]=arm-linux-gnueabihf [amd64]=x86_64-linux-gnu)
source "$repository/toolchains/private-apt.sh"

(cd "$repository" && cmake --preset "linux-$arch" && cmake --build "build/linux-$arch" && cd "build/linux-$arch" &&
  cpack) >"$work/build-$arch.log" 2>&1 || { tail -n 40 "$work/build-$arch.log"; exit 1; }
deb=$(echo "$repository/build/linux-$arch"/zerorate_*_"$arch".deb)
[[ $(dpkg-deb --field "$deb" Architecture) == "$arch" ]]

private_apt_root "$arch" "$work/apt-$arch"
APT_CONFIG="$work/apt-$arch/apt.conf" apt-get -qq --yes --no-install-recommends --download-only install "$deb"
root="$work/root-$arch"
rm -rf "$root"
mkdir -p "$root"
for package in "$work/apt-$arch"/cache/archives/*.deb "$deb"; do dpkg-deb -x "$package" "$root"; done
echo "$(find "$work/apt-$arch/cache/archives" -name '*.deb' | wc -l) packages for $(basename "$deb")"

# run PROGRAM ARGUMENT...: in the root's libraries and files.
run() {
  local program="$root$1"
  shift
  if [[ -n ${emulator[$arch]} ]]; then
    "${emulator[$arch]}" -L "$root" "$program" "$@"
  else
    # Its own loader and libraries; the kernel and the folders are this machine's.
    "$root/lib64/ld-linux-x86-64.so.2" --library-path "$root/lib/x86_64-linux-gnu:$root/usr/lib/x86_64-linux-gnu" \
      "$program" "$@"
  fi
}

run /usr/sbin/zerorated --check-config --config "$root/etc/zerorate/zerorated.toml"
[[ $(run /usr/bin/zerorate --version) == "zerorate $(dpkg-deb --field "$deb" Version)" ]]
run /usr/bin/zerorate model show lsm6dso | grep -q '^schema'
sed 's/rate_hz = 104/rate_hz = 105/' "$root/etc/zerorate/zerorated.toml" >"$work/wrong-$arch.toml"
if run /usr/sbin/zerorated --check-config --config "$work/wrong-$arch.toml" 2>"$work/wrong-$arch.log"; then exit 1; fi
grep -q 'wrong-.*:11:11: .*the chip offers' "$work/wrong-$arch.log"
for page in man1/zerorate.1 man8/zerorated.8 man5/zerorated.toml.5; do [[ -e "$root/usr/share/man/$page" ]]; done

# The example in C against libzerorate-dev.
dpkg-deb -x "$repository/build/linux-$arch"/libzerorate-dev_*_"$arch".deb "$root"
# shellcheck disable=SC2046 # a list of words
"${triplet[$arch]}-gcc" -o "$root/usr/bin/example" "$root/usr/share/doc/libzerorate-dev/examples/c/main.c" \
  $(PKG_CONFIG_LIBDIR="$root/usr/lib/${triplet[$arch]}/pkgconfig" pkg-config --cflags --libs zerorate-c)
run /usr/bin/example
echo "$arch: zerorated and zerorate run in the clean root"
