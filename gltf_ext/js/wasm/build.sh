#!/usr/bin/env bash
# gltf_ext/js/wasm/build.sh [OUT]
# Compiles the C decoder to WebAssembly with clang and wasm-ld (Debian: clang, lld) and writes it as a JavaScript module to OUT, by default
# src/wasm_binary.js of the package. Another version of clang gives other bytes, so the module says which one made it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
out=${1:-../src/wasm_binary.js}
clang=${CLANG:-clang}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

flags=(--target=wasm32 -std=c99 -Os -Wall -Wextra -Wconversion -Wshadow -Werror -ffreestanding -nostdlib -mbulk-memory -I. -I../../c)
"$clang" "${flags[@]}" -c nmc_wasm.c -o "$folder/nmc.o"
wasm-ld --no-entry --strip-all -O2 -z stack-size=65536 "$folder/nmc.o" -o "$folder/nmc.wasm"

{
  echo "// The C decoder as WebAssembly, base64. Made by wasm/build.sh with $("$clang" --version | sed -n '1s/.*clang version \([0-9]*\.[0-9]*\.[0-9]*\).*/clang \1/p')."
  echo "export const wasmBinary ="
  echo "  '$(base64 -w 0 "$folder/nmc.wasm")';"
} > "$folder/wasm_binary.js"
cat "$folder/wasm_binary.js" > "$out"
