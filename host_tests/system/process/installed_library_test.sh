#!/usr/bin/env bash
# installed_library_test.sh BUILD_FOLDER REPOSITORY CXX CC
#
# Installs the library as its package does and builds the examples in C++ and C against it, by
# find_package(zerorate) and by pkg-config. Nothing of the repository is in reach of them.
set -euo pipefail
build=$1 repository=$2 cxx=$3 cc=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --component library --prefix "$work/usr" >"$work/log"
cp -r "$repository"/docs/examples/{library,c} "$work"
export PKG_CONFIG_PATH="$work/usr/lib/pkgconfig"
expected='bias 0.0020 +- '

# by_cmake EXAMPLE: what the program says that find_package() makes of it.
by_cmake() {
  cmake -S "$work/$1" -B "$work/build-$1" -DCMAKE_PREFIX_PATH="$work/usr" -DCMAKE_CXX_COMPILER="$cxx" \
    -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_FLAGS=-Wall -DCMAKE_C_FLAGS=-Wall >>"$work/log"
  cmake --build "$work/build-$1" 2>&1 | tee -a "$work/log" | grep -i warning && exit 1
  "$work/build-$1/example"
}

# shellcheck disable=SC2046 # they are lists of words
by_pkg_config() {
  "$cxx" -std=c++20 -o "$work/library/by-pkg-config" $(pkg-config --cflags zerorate) "$work/library/main.cpp" \
    $(pkg-config --variable=sources zerorate)
  "$cc" -std=c11 -o "$work/c/by-pkg-config" $(pkg-config --cflags zerorate-c) "$work/c/main.c" \
    $(pkg-config --libs zerorate-c)
}

by_pkg_config
for example in library c; do
  said=$(by_cmake $example)
  [[ $said == "$expected"* ]] || { echo "find_package: $example said: $said"; exit 1; }
  [[ $("$work/$example/by-pkg-config") == "$said" ]] || { echo "pkg-config: another result of $example"; exit 1; }
  echo "$example: $said"
done
