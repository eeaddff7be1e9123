#!/usr/bin/env bash
# unit_tests.sh REPOSITORY arm64|armhf [TEST...]
#
# Builds the unit and contract tests of everything that runs on a board with Debian's cross compiler, and runs them
# under qemu-user; only those named, or all. Libraries of the architecture come from Debian: where it cannot be
# reached, this fails.
set -euo pipefail
repository=$(readlink -f "$1")
preset="linux-$2-tests"
shift 2
build="$repository/build/$preset"
log="$build/build.log"
mkdir -p "$build"
show() { tail -n 40 "$log"; exit 1; }

(cd "$repository" && cmake --preset "$preset") >"$log" 2>&1 || show
mapfile -t all < <(ctest --test-dir "$build" --show-only | sed -n 's/^  Test *#[0-9]*: //p')
if [[ $# -eq 0 ]]; then set -- "${all[@]}"; fi
cmake --build "$build" --target "$@" >>"$log" 2>&1 || show
ctest --test-dir "$build" --output-on-failure --tests-regex "^($(IFS='|' && echo "$*"))\$"
