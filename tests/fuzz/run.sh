#!/usr/bin/env bash
# tests/fuzz/run.sh [--seconds N] [NAME...]
# Builds the fuzzers with Clang and its sanitizers (preset debug) and runs them, two at a time. For each a line tells executions, coverage (edges of
# the code's graph) and inputs kept; what crashes is left as build-debug/fuzz/crash-NAME-*. The last line is "N passed, N failed".
#   --seconds N   how long each runs (default 60); a night: tests/fuzz/run.sh --seconds 28800. What was found stays in build-debug/fuzz/corpus/.
#   NAME          bvh, decoder, gltf, round_trip (default all)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

seconds=60
names=()
while [ $# -gt 0 ]; do
  case "$1" in
    --seconds) seconds=${2:?--seconds needs a number}; shift ;;
    bvh | decoder | gltf | round_trip) names+=("$1") ;;
    *) sed -n '2,7s/^# //p' "${BASH_SOURCE[0]}" >&2; exit 1 ;;
  esac
  shift
done
[ ${#names[@]} -gt 0 ] || names=(bvh decoder gltf round_trip)

# shellcheck source=../../samples/setup.sh
source samples/setup.sh
nmc_need_packages "${nmc_build_packages[@]}" clang libclang-rt-dev
nmc_build debug "${names[@]/#/fuzz_}"
programs=build-debug build=build-debug/fuzz
mkdir -p "$build"

# Draco comes without the sanitizers' marks in its vectors, which then look as if they overflowed.
export ASAN_OPTIONS=detect_container_overflow=0:${ASAN_OPTIONS:-}

run_one() {
  local name=$1 corpus=$build/corpus/$1 dictionary=() seeds=() slowest_seconds=25
  mkdir -p "$corpus"
  [ ! -f "tests/fuzz/$name.dict" ] || dictionary=(-dict="tests/fuzz/$name.dict")
  [ ! -d "tests/fuzz/seeds/$name" ] || seeds=("tests/fuzz/seeds/$name")
  [ "$name" != decoder ] || seeds=(tests/golden/good tests/golden/bad)
  # With sanitizers and without optimisation the encoder is some fifty times slower, and wild turns of a few joints take it half a second without.
  [ "$name" != round_trip ] || slowest_seconds=100
  local code=0
  "$programs/fuzz_$name" -max_total_time="$seconds" -timeout="$slowest_seconds" -rss_limit_mb=2048 -max_len=16384 -seed=1 -print_final_stats=1 "${dictionary[@]}" \
    -artifact_prefix="$build/crash-$name-" "$corpus" "${seeds[@]}" > "$build/$name.log" 2>&1 || code=$?
  local executions last
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/$name.log")
  last=$(grep -oE 'cov: [0-9]+ ft: [0-9]+ corp: [0-9]+' "$build/$name.log" | tail -1)
  echo "$name: ${executions:-0} executions, ${last:-no coverage}"
  if [ "$code" -ne 0 ]; then
    tail -40 "$build/$name.log" >&2
    touch "$build/failed-$name"
  fi
}

rm -f "$build"/failed-*
for name in "${names[@]}"; do
  while [ "$(jobs -rp | wc -l)" -ge 2 ]; do wait -n; done
  run_one "$name" &
done
wait

failed=$(find "$build" -maxdepth 1 -name 'failed-*' | wc -l)
echo "$((${#names[@]} - failed)) passed, $failed failed"
[ "$failed" -eq 0 ]
