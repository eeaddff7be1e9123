#!/usr/bin/env bash
# install-packages.sh [--list] demo|test|all
#
# Installs what a section of toolchains/debian-packages.txt and those above it name and this machine does not have.
# Says nothing where nothing is missing; needs root or sudo only where something is. --list prints the names instead.
set -euo pipefail
list="$(dirname "$(readlink -f "$0")")/debian-packages.txt"

# The lines of the list down to the end of a section, without comments: PACKAGE [unless COMMAND].
lines_to_section() {
  sed -e 's/#.*//' -e 's/[[:space:]]*$//' -e '/^$/d' "$list" |
    awk -v last="[$1]" '/^\[/ {if (seen) exit; seen = ($0 == last); next} {print}'
}

# The packages of a section that are neither installed nor made superfluous by a command.
missing_packages() {
  local installed package unless command
  installed=$(dpkg-query --show --showformat='${db:Status-Abbrev} ${Package}\n' | awk '$1 == "ii" {print $2}')
  while read -r package unless command; do
    if [[ "$unless" == unless ]] && command -v "$command" >/dev/null; then continue; fi
    grep --quiet --line-regexp --fixed-strings -- "$package" <<<"$installed" || echo "$package"
  done < <(lines_to_section "$1")
}

as_root() {
  if [[ $EUID -eq 0 ]]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    echo "install-packages: neither root nor sudo; install by hand: ${missing[*]}" >&2
    return 1
  fi
}

install_missing() {
  as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install --yes --quiet=2 --no-install-recommends -o DPkg::Lock::Timeout=600 \
    -o Dpkg::Use-Pty=0 "${missing[@]}" </dev/null
}

only_list=false
if [[ ${1:-} == --list ]]; then
  only_list=true
  shift
fi
if [[ $# -ne 1 ]] || ! grep --quiet --line-regexp --fixed-strings -- "[$1]" "$list"; then
  echo "usage: install-packages.sh [--list] demo|test|all" >&2
  exit 2
fi
if $only_list; then
  lines_to_section "$1" | cut -d' ' -f1
  exit 0
fi

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install-packages: this is no Debian system; the build goes on with what is installed" >&2
  exit 0
fi

mapfile -t missing < <(missing_packages "$1")
if [[ ${#missing[@]} -eq 0 ]]; then exit 0; fi

echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
# The package index may be absent, or so old that its files are gone from the archive.
if ! install_missing >/dev/null 2>&1; then
  as_root apt-get update --quiet=2 -o DPkg::Lock::Timeout=600 </dev/null
  install_missing >/dev/null
fi
