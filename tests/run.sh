#!/usr/bin/env bash
# tests/run.sh [--sanitize] [--filter REGEX]
# Builds gltf-nmc and runs all its tests. At the end a line for each that failed; the last line is "N passed, N failed[, N skipped]"; the exit code is 0 when none failed.
#   --sanitize       the C++ tests with Clang, AddressSanitizer and UndefinedBehaviorSanitizer, warnings as errors (build-debug/), and the fuzzers;
#                    of the optimised build the programs, the tests in JavaScript, and those in C++ that sanitizers make too slow
#   --filter REGEX   only the C++ tests whose names match
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=release
filter=
while [ $# -gt 0 ]; do
  case "$1" in
    --sanitize) preset=debug ;;
    --filter) filter=${2:?--filter needs a regular expression}; shift ;;
    *) sed -n '2,6s/^# //p' "$0" >&2; exit 1 ;;
  esac
  shift
done

# shellcheck source=samples/setup.sh
source samples/setup.sh
nmc_need_packages "${nmc_build_packages[@]}"
[ "$preset" = release ] || nmc_need_packages clang libclang-rt-dev
command -v npm > /dev/null || nmc_need_packages nodejs npm

echo "== node packages of the tests"
(cd tests && npm ci --no-audit --no-fund --loglevel=error)

passed=0 failed=0 skipped=0
# One line for each test that failed, printed before the summary: what they said is far above it.
failures=()

# run_cpp_tests PRESET FOLDER [CTEST OPTION...]: GoogleTest through CTest: one line per test, "***Skipped" for those that skipped, "***<reason>" for those that failed.
run_cpp_tests() {
  echo "== C++ tests ($1)"
  local log=$2/ctest.log
  local -a options=(--test-dir "$2" --output-on-failure --no-tests=error -j "$(nproc)" "${@:3}")
  [ -z "$filter" ] || options+=(-R "$filter")
  ctest "${options[@]}" 2>&1 | tee "$log" || true
  local ran skipped_here not_passed line
  ran=$(grep -cE '^ *[0-9]+/[0-9]+ Test +#' "$log" || true)
  skipped_here=$(grep -cE '^ *[0-9]+/[0-9]+ Test +#.*\*\*\*Skipped' "$log" || true)
  not_passed=0
  while IFS= read -r line; do
    not_passed=$((not_passed + 1))
    failures+=("$1: $line")
  done < <(grep -E '^ *[0-9]+/[0-9]+ Test +#' "$log" | grep -vE '\*\*\*Skipped' | grep -E '\*\*\*| Not Run ' || true)
  if [ "$ran" -eq 0 ]; then
    failures+=("$1: ctest ran no test")
    not_passed=1 ran=1
  fi
  passed=$((passed + ran - skipped_here - not_passed))
  failed=$((failed + not_passed))
  skipped=$((skipped + skipped_here))
}

# node --test on a folder; its summary lines are "# pass N" and so on (the TAP reporter).
run_node_tests() {
  local folder=$1 log=build/node.log
  [ -d "$folder" ] || return 0
  echo "== JavaScript tests ($folder)"
  [ ! -f "$folder/package-lock.json" ] || (cd "$folder" && npm ci --no-audit --no-fund --loglevel=error)
  local code=0
  (cd "$folder" && node --test --test-reporter=tap) 2>&1 | tee "$log" || code=$?
  count() { sed -n "s/^# $1 \([0-9]*\)$/\1/p" "$log" | tail -1; }
  local pass fail skip cancelled line
  pass=$(count pass) fail=$(count fail) skip=$(count skipped) cancelled=$(count cancelled)
  fail=$((${fail:-0} + ${cancelled:-0}))
  while IFS= read -r line; do failures+=("$folder: $line"); done < <(grep -E '^ *not ok ' "$log" || true)
  if [ "$code" -ne 0 ] && [ "$fail" -eq 0 ]; then
    fail=1
    failures+=("$folder: node ended with $code")
  fi
  passed=$((passed + ${pass:-0}))
  failed=$((failed + fail))
  skipped=$((skipped + ${skip:-0}))
}

# The fuzzers belong to the build with sanitizers.
run_fuzzers() {
  local log=build-debug/fuzz.log
  echo "== fuzzers"
  bash tests/fuzz/run.sh --seconds 60 2>&1 | tee "$log" || true
  if [[ "$(tail -1 "$log")" =~ ^([0-9]+)\ passed,\ ([0-9]+)\ failed$ ]]; then
    passed=$((passed + BASH_REMATCH[1]))
    failed=$((failed + BASH_REMATCH[2]))
    [ "${BASH_REMATCH[2]}" -eq 0 ] || failures+=("fuzzers: see build-debug/fuzz.log")
  else
    failed=$((failed + 1))
    failures+=("fuzzers: ended early, see build-debug/fuzz.log")
  fi
}

# Tests that sanitizers tell nothing about and make too slow: those that start or stop the tool very often, those of the generator of the sample
# characters, and those that compress once more what others compress with sanitizers. And those that skip themselves in a build with sanitizers.
unsanitized='^(Pipeline|Batch|Characters)[.]|^Faults[.](Killed|Interrupted|TwoRuns)|AnyNumberOfThreadsAndAgain|EyesOfTheValidator'
optimised="$unsanitized|RealFiles|LargeOnes|ThePageSays|EyesOfTheReferee|TooLittleMemory"

if [ "$preset" = release ]; then
  nmc_build release
  run_cpp_tests release build
elif [ -n "$filter" ]; then
  nmc_build debug
  run_cpp_tests debug build-debug
else
  nmc_build release programs test_cli_long test_corpus test_samples
  run_cpp_tests release build -R "$optimised"
  nmc_build debug
  run_cpp_tests debug build-debug -E "$unsanitized"
  run_fuzzers
fi
if [ -z "$filter" ]; then
  # Without Chromium the tests in pages skip.
  nmc_need_packages chromium || echo "Chromium cannot be installed" >&2
  NMC_TOOL=build/gltf-nmc run_node_tests tests/js
fi

[ "${#failures[@]}" -eq 0 ] || printf 'FAILED: %s\n' "${failures[@]}"
if [ "$skipped" -gt 0 ]; then
  echo "$passed passed, $failed failed, $skipped skipped"
else
  echo "$passed passed, $failed failed"
fi
[ "$failed" -eq 0 ]
