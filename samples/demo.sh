#!/usr/bin/env bash
# Builds the tool, makes sample characters, compresses one with a report for the browser, decodes it again, and checks that the error bound was kept.
set -euo pipefail
source "$(dirname "$0")/setup.sh"

nmc_need_packages "${nmc_build_packages[@]}"
nmc_build release gltf-nmc make_characters

samples=$nmc_root/build/samples
tool=$nmc_root/build/gltf-nmc
nmc_say "making the sample characters"
"$nmc_root/build/make_characters" "$samples"

original=$samples/humanoid_30hz.glb
compressed=$samples/humanoid_30hz.nmc.glb
decoded=$samples/humanoid_30hz.decoded.glb
nmc_say "compressing humanoid_30hz.glb"
"$tool" "$original" "$compressed" --report "$samples/report.html"
nmc_say "decoding it again"
"$tool" decode "$compressed" "$decoded"
nmc_say "verifying: original against decoded"
"$tool" verify "$original" "$decoded"

nmc_say "sizes in bytes"
for file in "$original" "$compressed" "$decoded"; do
  printf '%10d  %s\n' "$(stat -c %s "$file")" "${file#"$nmc_root/"}"
done

nmc_say "the report: open ${samples#"$nmc_root/"}/report.html in a browser"
