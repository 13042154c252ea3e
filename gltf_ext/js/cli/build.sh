#!/usr/bin/env bash
# gltf_ext/js/cli/build.sh [FOLDER]
# Compiles the command line to WebAssembly for Node and puts it into the npm package: bin/gltf-nmc.wasm, bin/gltf-nmc.cjs, which loads it, and
# bin/licences.txt, of the libraries in it.
# For Debian 12: takes what it needs from there, the libraries that have code of their own as source packages. Works in FOLDER, by default build-wasm of
# the tree, and does not do again what is there. CMAKE_BUILD_PARALLEL_LEVEL is the number of compilers at a time, by default one for each processor.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../../.." && pwd)
folder=$(realpath -m "${1:-$root/build-wasm}")
sources=$folder/sources
prefix=$folder/prefix
export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
# Debian's emscripten needs Debian's acorn, which a Node from elsewhere does not look for there.
export NODE_PATH=/usr/share/nodejs

# shellcheck source=samples/setup.sh
source "$root/samples/setup.sh"
headers=(libglm-dev libeigen3-dev libcli11-dev nlohmann-json3-dev libtinygltf-dev libstb-dev libxxhash-dev)
nmc_need_packages emscripten node-acorn cmake ninja-build dpkg-dev "${headers[@]}"
mkdir -p "$sources" "$prefix/include"

# Node 18 and later have both features; exceptions through JavaScript would make every call that may throw slow.
flags="-msimd128 -fwasm-exceptions"

# copy_headers PACKAGE...: the headers of libraries that have no code, alone: beside those of the host's C library they could not be used.
copy_headers() {
  local file
  dpkg -L "$@" | { grep -E '^/usr/(include|share/cmake|share/eigen3)/' || true; } | while read -r file; do
    [ -d "$file" ] || install -D -m 644 "$file" "$prefix/${file#/usr/}"
  done
  # Eigen's code for SSE, which emscripten turns into WebAssembly's: a header that emscripten lacks and nothing of which is used; and inline
  # assembly around a bug of old versions of GCC, which Clang is taken for.
  : > "$prefix/include/mmintrin.h"
  sed -i 's/^#if EIGEN_COMP_GNUC && EIGEN_COMP_GNUC < 63/#if EIGEN_COMP_GNUC_STRICT \&\& EIGEN_COMP_GNUC < 63/' \
    "$prefix/include/eigen3/Eigen/src/Core/arch/SSE/PacketMath.h"
}

# get_sources PACKAGE...: from where apt gets Debian's packages, without a change of the system's list of sources.
get_sources() {
  local list=$folder/sources.list lists=$folder/lists
  mkdir -p "$lists/partial"
  apt-get indextargets --format "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] \$(REPO_URI) \$(CODENAME) \$(COMPONENT)" \
    "Created-By: Packages" "Origin: Debian" | sort -u > "$list"
  local options=(-qq -o "Dir::Etc::sourcelist=$list" -o Dir::Etc::sourceparts=- -o "Dir::State::lists=$lists" -o APT::Sandbox::User=root)
  apt-get "${options[@]}" update
  (cd "$sources" && apt-get "${options[@]}" source "$@")
}

# compile SOURCE CMAKE_OPTION...: a library for WebAssembly, installed in the prefix.
compile() {
  local source=$1 build
  shift
  build=$folder/$(basename "$source")
  nmc_say "building $source"
  emcmake cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_INSTALL_LIBDIR=lib \
    -DCMAKE_C_FLAGS="$flags -w" -DCMAKE_CXX_FLAGS="$flags -w" -DBUILD_SHARED_LIBS=OFF "$@" > /dev/null
  cmake --build "$build"
  cmake --install "$build" > /dev/null
}

build_libraries() {
  copy_headers "${headers[@]}"
  get_sources draco fmtlib libzstd meshoptimizer
  compile "$sources"/fmtlib-*/ -DFMT_TEST=OFF -DFMT_DOC=OFF
  compile "$sources"/meshoptimizer-*/
  compile "$sources"/libzstd-*/build/cmake -DZSTD_BUILD_PROGRAMS=OFF -DZSTD_BUILD_SHARED=OFF -DZSTD_MULTITHREAD_SUPPORT=OFF
  # For emscripten Draco's CMake files build a JavaScript library and no C++ one.
  echo 'set(EMSCRIPTEN OFF)' > "$folder/draco_as_library.cmake"
  compile "$sources"/draco-*/ -DDRACO_TESTS=OFF -DCMAKE_PROJECT_draco_INCLUDE="$folder/draco_as_library.cmake"
  touch "$folder/libraries"
}

# What the licences of everything that is in the WebAssembly ask for, as Debian gathered it.
print_licences() {
  local package
  for package in "${headers[@]}" emscripten; do
    printf '==== %s\n\n' "$package"
    cat "/usr/share/doc/$package/copyright"
  done
  for package in "$sources"/*/; do
    printf '==== %s\n\n' "$(basename "$package")"
    cat "$package/debian/copyright"
  done
}

[ -f "$folder/libraries" ] || build_libraries

nmc_say "building gltf-nmc"
emcmake cmake -S "$root" -B "$folder/gltf-nmc" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_FIND_ROOT_PATH="$prefix" \
  -DCMAKE_C_FLAGS="$flags" -DCMAKE_CXX_FLAGS="$flags -msse4.2" -DNMC_PORTABLE=ON -DNMC_PRECOMPILE=ON \
  -DBUILD_TESTING=OFF -DNMC_BUILD_BENCH=OFF -DNMC_BUILD_SAMPLES=OFF > /dev/null
cmake --build "$folder/gltf-nmc" --target gltf-nmc
install -m 644 "$folder/gltf-nmc/gltf-nmc.wasm" "$here/../bin/gltf-nmc.wasm"
install -m 644 "$folder/gltf-nmc/gltf-nmc.js" "$here/../bin/gltf-nmc.cjs"
print_licences > "$here/../bin/licences.txt"
ls -l "$here/../bin"
