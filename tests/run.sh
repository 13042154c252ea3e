#!/usr/bin/env bash
# tests/run.sh [--sanitize] [--filter REGEX]
# Builds gltf-nmc and runs all its tests. The last line is "N passed, N failed[, N skipped]"; the exit code is 0 when none failed.
#   --sanitize       build with Clang, AddressSanitizer and UndefinedBehaviorSanitizer, warnings as errors (build-debug/)
#   --filter REGEX   only the C++ tests whose names match
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=release
build=build
filter=
while [ $# -gt 0 ]; do
  case "$1" in
    --sanitize) preset=debug build=build-debug ;;
    --filter) filter=${2:?--filter needs a regular expression}; shift ;;
    *) sed -n '2,5s/^# //p' "$0" >&2; exit 1 ;;
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

echo "== build ($preset)"
nmc_build "$preset"

passed=0 failed=0 skipped=0

# GoogleTest through CTest: one line per test, "***Skipped" for those that skipped, "***<reason>" for those that failed.
run_cpp_tests() {
  echo "== C++ tests ($preset)"
  local log=$build/ctest.log
  local -a options=(--test-dir "$build" --output-on-failure --no-tests=error -j "$(nproc)")
  [ -z "$filter" ] || options+=(-R "$filter")
  ctest "${options[@]}" 2>&1 | tee "$log" || true
  local ran skipped_here not_passed
  ran=$(grep -cE '^ *[0-9]+/[0-9]+ Test +#' "$log" || true)
  skipped_here=$(grep -cE '^ *[0-9]+/[0-9]+ Test +#.*\*\*\*Skipped' "$log" || true)
  not_passed=$(grep -E '^ *[0-9]+/[0-9]+ Test +#' "$log" | grep -vE '\*\*\*Skipped' | grep -cE '\*\*\*| Not Run ' || true)
  if [ "$ran" -eq 0 ]; then
    echo "ctest ran no test" >&2
    not_passed=1 ran=1
  fi
  passed=$((passed + ran - skipped_here - not_passed))
  failed=$((failed + not_passed))
  skipped=$((skipped + skipped_here))
}

# node --test on a folder; its summary lines are "# pass N" and so on (the TAP reporter).
run_node_tests() {
  local folder=$1 log=$build/node.log
  [ -d "$folder" ] || return 0
  echo "== JavaScript tests ($folder)"
  [ ! -f "$folder/package-lock.json" ] || (cd "$folder" && npm ci --no-audit --no-fund --loglevel=error)
  local code=0
  (cd "$folder" && node --test --test-reporter=tap) 2>&1 | tee "$log" || code=$?
  count() { sed -n "s/^# $1 \([0-9]*\)$/\1/p" "$log" | tail -1; }
  local pass fail skip cancelled
  pass=$(count pass) fail=$(count fail) skip=$(count skipped) cancelled=$(count cancelled)
  fail=$((${fail:-0} + ${cancelled:-0}))
  if [ "$code" -ne 0 ] && [ "$fail" -eq 0 ]; then fail=1; fi
  passed=$((passed + ${pass:-0}))
  failed=$((failed + fail))
  skipped=$((skipped + ${skip:-0}))
}

run_cpp_tests
# Without Chromium the tests in pages skip.
[ -n "$filter" ] || [ "$preset" != release ] || nmc_need_packages chromium || echo "Chromium cannot be installed" >&2
# Sanitizers watch C++ alone, and the tool is ten times slower under them.
[ -n "$filter" ] || [ "$preset" != release ] || NMC_TOOL=$build/gltf-nmc run_node_tests tests/js

# The fuzzers belong to the build with sanitizers.
run_fuzzers() {
  local log=$build/fuzz.log
  echo "== fuzzers"
  bash tests/fuzz/run.sh --seconds 60 2>&1 | tee "$log" || true
  if [[ "$(tail -1 "$log")" =~ ^([0-9]+)\ passed,\ ([0-9]+)\ failed$ ]]; then
    passed=$((passed + BASH_REMATCH[1]))
    failed=$((failed + BASH_REMATCH[2]))
  else
    failed=$((failed + 1))
  fi
}
[ -n "$filter" ] || [ "$preset" = release ] || run_fuzzers

if [ "$skipped" -gt 0 ]; then
  echo "$passed passed, $failed failed, $skipped skipped"
else
  echo "$passed passed, $failed failed"
fi
[ "$failed" -eq 0 ]
