#!/usr/bin/env bash
# tests/fuzz/run.sh [--seconds N] [NAME...]
# Builds the fuzzers with Clang and its sanitizers (build-fuzz/) and runs them, two at a time. For each a line tells executions, coverage (edges of
# the code's graph) and inputs kept; what crashes is left as build-fuzz/crash-NAME-*. The last line is "N passed, N failed[, N skipped]".
#   --seconds N   how long each runs (default 60); a night: tests/fuzz/run.sh --seconds 28800. What was found stays in build-fuzz/corpus/.
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

if ! command -v clang++ > /dev/null; then
  echo "Clang is not installed: the fuzzers are not run"
  echo "0 passed, 0 failed, ${#names[@]} skipped"
  exit 0
fi

build=build-fuzz
launcher=()
[ -z "${CMAKE_CXX_COMPILER_LAUNCHER:-}" ] || launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER="$CMAKE_CXX_COMPILER_LAUNCHER")
cmake -S . -B "$build" -G Ninja -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_CXX_FLAGS_DEBUG="-O1 -gline-tables-only" -DNMC_BUILD_FUZZERS=ON -DNMC_WERROR=ON -DNMC_BUILD_SAMPLES=OFF -DNMC_BUILD_BENCH=OFF \
  -DBUILD_TESTING=OFF "${launcher[@]}" > /dev/null
cmake --build "$build" --parallel "$(nproc)" --target "${names[@]/#/fuzz_}"

# Draco comes without the sanitizers' marks in its vectors, which then look as if they overflowed.
export ASAN_OPTIONS=detect_container_overflow=0:${ASAN_OPTIONS:-}

run_one() {
  local name=$1 corpus=$build/corpus/$1 dictionary=() seeds=()
  mkdir -p "$corpus"
  [ ! -f "tests/fuzz/$name.dict" ] || dictionary=(-dict="tests/fuzz/$name.dict")
  [ ! -d "tests/fuzz/seeds/$name" ] || seeds=("tests/fuzz/seeds/$name")
  [ "$name" != decoder ] || seeds=(tests/golden/good tests/golden/bad)
  local code=0
  "$build/fuzz_$name" -max_total_time="$seconds" -timeout=25 -rss_limit_mb=2048 -max_len=16384 -seed=1 -print_final_stats=1 "${dictionary[@]}" \
    -artifact_prefix="$build/crash-$name-" "$corpus" "${seeds[@]}" > "$build/fuzz_$name.log" 2>&1 || code=$?
  local executions last
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/fuzz_$name.log")
  last=$(grep -oE 'cov: [0-9]+ ft: [0-9]+ corp: [0-9]+' "$build/fuzz_$name.log" | tail -1)
  echo "$name: ${executions:-0} executions, ${last:-no coverage}"
  if [ "$code" -ne 0 ]; then
    tail -40 "$build/fuzz_$name.log" >&2
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
