# Shared by the scripts that build this project on a bare machine; to be sourced. Needs Debian's or Ubuntu's apt-get.

nmc_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# What building needs.
nmc_build_packages=(g++ cmake ninja-build libglm-dev libeigen3-dev libdraco-dev libtinygltf-dev libcli11-dev libfmt-dev
                    nlohmann-json3-dev libmeshoptimizer-dev libstb-dev libxxhash-dev libzstd-dev libgtest-dev libgmock-dev)

nmc_say() { printf '== %s\n' "$*"; }

# nmc_need_packages PACKAGE...: installs those that are missing; does nothing when none is.
nmc_need_packages() {
  local package missing=() as_root=()
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  nmc_say "installing ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
}

# nmc_build PRESET [TARGET...]: configures by a preset of CMakePresets.json and builds everything, or these targets.
nmc_build() {
  local preset=$1
  shift
  nmc_say "building (preset $preset)"
  local folder=$nmc_root/build
  [ "$preset" = release ] || folder=$nmc_root/build-$preset
  local generator=()
  [ -f "$folder/CMakeCache.txt" ] || generator=(-G Ninja)
  (cd "$nmc_root" && cmake --preset "$preset" -DNMC_PRECOMPILE=ON "${generator[@]}" >/dev/null &&
    cmake --build --preset "$preset" --parallel "$(nproc)" ${1:+--target "$@"})
}
