#!/usr/bin/env bash
# fetch-sysroot.sh ARCH DIR SUITE PACKAGE...: unpacks Debian packages of another architecture into DIR; of another
# suite than this machine's, unless SUITE is empty.
set -euo pipefail
arch=$1 dir=$2 suite=$3
shift 3
source "$(dirname "$(readlink -f "$0")")/private-apt.sh"
mkdir -p "$dir"
dir=$(readlink -f "$dir")
private_apt_root "$arch" "$dir.apt" "$suite"
rm -rf "$dir.debs"  # of an earlier call: other packages, and other versions of these
private_apt_download "$dir.apt" "$dir.debs" "$@"
for deb in "$dir.debs"/*.deb; do dpkg-deb -x "$deb" "$dir"; done
rm -rf "$dir.debs"
