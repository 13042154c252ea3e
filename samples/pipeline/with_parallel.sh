#!/usr/bin/env bash
# samples/pipeline/with_parallel.sh ASSETS OUT [gltf-nmc options]
# Compresses every .glb and .gltf below ASSETS into the same place below OUT with GNU parallel. Run it again after an
# interruption: what is done is not done again. The log of all jobs is OUT/jobs.log.
#   GLTF_NMC=gltf-nmc    the tool
#   JOBS=100%            jobs at the same time: a number, or a share of the processors
#   CACHE=OUT/.cache     results of earlier runs
#   HOSTS=FILE           machines to use by ssh, one a line (4/user@host; : is this one), that see the files under the same path
set -euo pipefail
[ $# -ge 2 ] || { sed -n '2,8s/^# //p' "$0" >&2; exit 1; }

assets=$1 out=$2
shift 2
mkdir -p "$out"
out=$(cd "$out" && pwd)
tool=$(command -v "${GLTF_NMC:-gltf-nmc}") || { echo "there is no ${GLTF_NMC:-gltf-nmc}" >&2; exit 1; }
tool=$(realpath "$tool")
cache=$(realpath -m "${CACHE:-$out/.cache}")
hosts=()
[ -z "${HOSTS:-}" ] || hosts=(--sshloginfile "$(realpath "$HOSTS")" --workdir "$(realpath "$assets")")
cd "$assets"

# The log counts jobs by their place in the list: with other files or options it starts anew, and the cache still knows
# what was compressed before.
{ printf '%s\n' "$tool $*"; find . \( -name '*.glb' -o -name '*.gltf' \) -type f -printf '%P %T@ %s\n' | LC_ALL=C sort; } > "$out/jobs.new"
cmp -s "$out/jobs.new" "$out/jobs.list" || rm -f "$out/jobs.log"
mv "$out/jobs.new" "$out/jobs.list"

find . \( -name '*.glb' -o -name '*.gltf' \) -type f -printf '%P\0' | LC_ALL=C sort -z |
  parallel --null --quote --jobs "${JOBS:-100%}" --joblog "$out/jobs.log" --resume-failed --line-buffer "${hosts[@]}" \
    "$tool" --quiet --threads 1 --cache "$cache" "$@" {} -o "$out/{//}" || failed=$?
echo "$(awk 'NR > 1 && $7 == 0' "$out/jobs.log" | wc -l) of $(($(wc -l < "$out/jobs.list") - 1)) files done"
exit "${failed:-0}"
