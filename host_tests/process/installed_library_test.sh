#!/usr/bin/env bash
# installed_library_test.sh BUILD_FOLDER REPOSITORY CXX
#
# Installs the library as its package does and builds the example against it, by find_package(zerorate) and by
# pkg-config. Nothing of the repository is in reach of either.
set -euo pipefail
build=$1 repository=$2 cxx=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --component library --prefix "$work/usr" >"$work/log"
cp -r "$repository/docs/examples/library" "$work/example"
expected='bias 0.0020 +- '

cmake -S "$work/example" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/usr" -DCMAKE_CXX_COMPILER="$cxx" \
  -DCMAKE_CXX_FLAGS="-Wall" >>"$work/log"
cmake --build "$work/build" 2>&1 | tee -a "$work/log" | grep -i warning && exit 1
said=$("$work/build/example")
[[ $said == "$expected"* ]] || { echo "find_package: the example said: $said"; exit 1; }

export PKG_CONFIG_PATH="$work/usr/share/pkgconfig"
# shellcheck disable=SC2046 # they are lists of words
"$cxx" -std=c++20 -o "$work/by-pkg-config" $(pkg-config --cflags zerorate) "$work/example/main.cpp" \
  $(pkg-config --variable=sources zerorate)
[[ $("$work/by-pkg-config") == "$said" ]] || { echo "pkg-config: another result"; exit 1; }
echo "both: $said"
