# Sourced: packages of any architecture from this machine's own Debian sources, by a private index, so that
# nothing is added to the machine's.

# private_apt_root ARCH DIR [SUITE]: makes the index once; of another suite of Debian than this machine's, where
# one is named.
private_apt_root() {
  local arch=$1 root=$2 suite=${3:-}
  if [[ -e $root/ready ]]; then return; fi
  mkdir -p "$root"/etc/{preferences.d,sources.list.d} "$root/state/lists/partial" "$root/cache/archives/partial"
  : >"$root/status"
  if [[ -e /etc/apt/sources.list.d/debian.sources ]]; then
    sed "/^URIs:/a Architectures: $arch" /etc/apt/sources.list.d/debian.sources >"$root/etc/sources.list.d/debian.sources"
  else
    sed -n "s/^deb  *\(\[[^]]*\]  *\)\{0,1\}\(.*debian.*\)/deb [arch=$arch] \2/p" /etc/apt/sources.list >"$root/etc/sources.list.d/debian.list"
  fi
  if [[ -n $suite ]]; then
    sed -i "s/$(. /etc/os-release && echo "$VERSION_CODENAME")/$suite/g" "$root"/etc/sources.list.d/*
  fi
  cat >"$root/apt.conf" <<CONF
APT::Architecture "$arch"; APT::Architectures { "$arch"; };
Dir::Etc::sourcelist "/dev/null"; Dir::Etc::sourceparts "$root/etc/sources.list.d"; Dir::Etc::preferencesparts "$root/etc/preferences.d";
Dir::State "$root/state"; Dir::State::status "$root/status"; Dir::Cache "$root/cache";
Acquire::Languages "none"; Acquire::Retries "5"; APT::Sandbox::User "root";
CONF
  # A mirror in the middle of its own update gives part of its index: once more, and then with that part, until the
  # next time. Where Debian is not reached there is none, and whatever is asked for next fails.
  private_apt_update "$root" || private_apt_update "$root" || return 0
  touch "$root/ready"
}

# private_apt_update ROOT: fails where a part is missing, though what is there can be used.
private_apt_update() {
  APT_CONFIG="$1/apt.conf" apt-get -qq -o APT::Update::Error-Mode=any update
}

# private_apt_download ROOT FOLDER PACKAGE...: the .deb files, into the folder.
private_apt_download() {
  local root=$1 folder=$2
  shift 2
  mkdir -p "$folder"
  (cd "$folder" && APT_CONFIG="$root/apt.conf" apt-get -qq download "$@")
}
