# Shared by demo and test; source it. Goes to the repository's root and installs what is missing.
# shellcheck shell=bash

cd "$(dirname "${BASH_SOURCE[0]}")/.."

# The only list of what posewise needs, as Debian and Ubuntu name it.
packages=(
  g++ cmake ninja-build ccache python3
  libeigen3-dev libyaml-cpp-dev nlohmann-json3-dev libfmt-dev libmatio-dev libminizip-dev zlib1g-dev libnlopt-dev
  libpugixml-dev libsqlite3-dev libboost-math-dev libcli11-dev libgtest-dev gnuplot-nox
)

is_installed() {
  # Any flavour of gnuplot will do.
  if [[ $1 == gnuplot-nox ]] && command -v gnuplot >/dev/null; then return 0; fi
  [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

# install_packages <package>...: those that are not there yet.
install_packages() {
  if ! command -v apt-get >/dev/null; then
    echo "No apt-get here: please install these (or their like) yourself: $*" >&2
    return 0
  fi
  local missing=() as_root=() package
  for package in "$@"; do
    is_installed "$package" || missing+=("$package")
  done
  if ((${#missing[@]} == 0)); then return 0; fi
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      echo "Missing packages, and neither root nor sudo to install them. As root, run:" >&2
      echo "  apt-get update && apt-get install ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  echo "Installing: ${missing[*]}" >&2
  "${as_root[@]}" apt-get update --quiet
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install --quiet --yes --no-install-recommends "${missing[@]}"
}

# What was compiled once, here or in another clone, is not compiled again, precompiled headers included.
use_ccache() {
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
  export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
}

# build <preset> [<argument of cmake --build>...]; `build_options` go to CMake.
build_options=()
build() {
  local preset=$1 options=("${build_options[@]}")
  shift
  use_ccache
  if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  cmake --preset "$preset" "${options[@]}"
  cmake --build --preset "$preset" "$@"
}

install_packages "${packages[@]}"
