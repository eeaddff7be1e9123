#!/usr/bin/env bash
# clean_root.sh REPOSITORY WORK_FOLDER arm64|armhf|amd64
#
# Builds the node's Debian package for an architecture, lets apt find everything it depends on in Debian's
# archive, as on a machine that has nothing yet, unpacks all of it into an empty root, and runs the programs
# there: under qemu-user where this machine has another processor. On amd64 the package is also installed for real, in a
# Debian of its own: lintian finds nothing, the package's own tests (toolchains/debian/tests/control) pass, and a
# purge leaves nothing.
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
for page in man1/zerorate.1 man8/zerorated.8 man5/zerorated.toml.5; do [[ -e "$root/usr/share/man/$page.gz" ]]; done
# What the node's build of the tool has: recordings, and an answer for those commands that it lacks.
rm -f "$work/rest-$arch.csv.gz"
run /usr/bin/zerorate record --chip simulated --duration 3s --output "$work/rest-$arch.csv.gz"
[[ $(gzip -dc "$work/rest-$arch.csv.gz" | wc -l) -gt 300 ]]
if run /usr/bin/zerorate characterize "$work/rest-$arch.csv.gz" 2>"$work/desktop-$arch.log"; then exit 1; fi
grep -q 'characterize is in the desktop build of zerorate' "$work/desktop-$arch.log"

# The example in C against libzerorate-dev.
dpkg-deb -x "$repository/build/linux-$arch"/libzerorate-dev_*_"$arch".deb "$root"
# shellcheck disable=SC2046 # a list of words
"${triplet[$arch]}-gcc" -o "$root/usr/bin/example" "$root/usr/share/doc/libzerorate-dev/examples/c/main.c" \
  $(PKG_CONFIG_LIBDIR="$root/usr/lib/${triplet[$arch]}/pkgconfig" pkg-config --cflags --libs zerorate-c)
run /usr/bin/example
echo "$arch: zerorated and zerorate run in the clean root"
if [[ $arch != amd64 ]]; then exit; fi

lintian --allow-root --fail-on error,warning "$repository/build/linux-$arch"/{zerorate,libzerorate-dev}_*_"$arch".deb
echo "$arch: lintian finds neither an error nor a warning"
if [[ $(id -u) != 0 ]]; then echo "$arch: not root: the package is not installed"; exit; fi

# A Debian with what the package and its tests depend on, made once.
base="$work/debian-$arch.tar"
if [[ ! -f $base ]]; then
  depends=$(dpkg-deb --field "$deb" Depends | sed 's/ *([^)]*)//g; s/, */,/g')
  mmdebstrap --quiet --mode=root --variant=apt --include="$depends,adduser,apt-utils,dpkg-dev" \
    "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$work/unfinished.tar" /etc/apt/sources.list.d/debian.sources
  mv "$work/unfinished.tar" "$base"
fi
debian="$work/debian-$arch"
rm -rf --one-file-system "$debian"
mkdir "$debian"
tar -C "$debian" -xf "$base"

# autopkgtest wants a source package round the tests; CPack makes none.
source="$work/source"
rm -rf "$source"
mkdir -p "$source/debian"
cp -r "$repository/toolchains/debian/tests" "$source/debian/"
gzip -dc "$root/usr/share/doc/zerorate/changelog.gz" >"$source/debian/changelog"
printf 'Source: zerorate\nMaintainer: %s\n\nPackage: zerorate\nArchitecture: any\nDescription: the node\n' \
  "$(dpkg-deb --field "$deb" Maintainer)" >"$source/debian/control"
mount -t proc proc "$debian/proc"
trap 'umount "$debian/proc"' EXIT
autopkgtest --log-file "$work/autopkgtest.log" "$deb" "$source//" -- chroot "$debian" >/dev/null ||
  { tail -n 60 "$work/autopkgtest.log"; exit 1; }
sed -n '/summary$/,$p' "$work/autopkgtest.log"

# The package stays installed.
inside() { env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 chroot "$debian" "$@"; }
cp "$deb" "$debian/zerorate.deb"
echo "# changed" >>"$debian/etc/zerorate/zerorated.toml"
inside dpkg --install /zerorate.deb
grep -q '^# changed' "$debian/etc/zerorate/zerorated.toml"
inside dpkg --purge zerorate
for path in etc/zerorate var/lib/zerorate usr/bin/zerorate lib/systemd/system/zerorated.service; do [[ ! -e $debian/$path ]]; done
if inside id zerorate 2>/dev/null; then exit 1; fi
echo "$arch: an upgrade keeps the configuration, a purge leaves nothing"
