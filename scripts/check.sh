#!/usr/bin/env bash
# check.sh [PART...]: runs checks that take too long for every change. By default it runs all parts, which takes
# hours.
#   words      plain words: comments, names, messages, sentences of guides
#   gcc clang  builds without warnings, every file by itself
#   asan       address and undefined-behaviour sanitizers, all tests but the slow and nightly ones
#   tsan       thread sanitizer, the tests labelled parallel
#   tidy       clang-tidy on the product
#   fuzz       a minute of each fuzz target
#   nightly    the nightly tests with fresh seeds; FLATSPECKLE_TEST_SEED repeats those of a failure
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

without_warnings() {  # PRESET OPTIMISATION: of gcc's warnings, some require that it optimises
  cmake --preset "$1" -DCMAKE_CXX_FLAGS=-Werror -DCMAKE_CXX_FLAGS_DEBUG="$2" -DFLATSPECKLE_BENCH=ON
  cmake --build --preset "$1" --parallel "$jobs" -- -k 0
}

sanitized() {  # PRESET
  cmake --preset "$1"
  cmake --build --preset "$1" --parallel "$jobs"
  ctest --preset "$1" --parallel "$jobs"
}

tidy() {
  cmake --preset clang
  run-clang-tidy -quiet -p build/clang -j "$jobs" \
    "$PWD/(core|flatland|wave_solver|grin|mc|apps|bench)/"
}

fuzz() {
  cmake --preset fuzz
  cmake --build --preset fuzz --parallel "$jobs"
  ctest --preset fuzz
  local target found
  for target in scene table grid result result_bytes; do
    found=$PWD/build/fuzz/found/$target
    mkdir -p "$found"
    # HDF5 itself crashes on damaged files, so it runs in a child process: docs/development.md.
    ASAN_OPTIONS=allocator_may_return_null=1 build/fuzz/bin/fuzz --target=$target -max_total_time=60 \
      -max_len=2500 -rss_limit_mb=2048 -timeout=60 -detect_leaks=0 -malloc_limit_mb=0 \
      -artifact_prefix="$found/" "$found" "$PWD/tests/fuzz/corpus/$target"
  done
}

words() {
  python3 -B tests/verify/test_words.py
}

nightly() {
  build_release all -DFLATSPECKLE_TESTS=ON
  export FLATSPECKLE_TEST_SEED=${FLATSPECKLE_TEST_SEED:-$(date +%Y%m%d)}
  echo "FLATSPECKLE_TEST_SEED=$FLATSPECKLE_TEST_SEED"
  ctest --preset nightly --parallel "$jobs"
}

install_build_packages
install_test_packages
install_missing clang clang-tidy libomp-dev libbenchmark-dev
[[ $# -gt 0 ]] || set -- words gcc clang asan tsan tidy fuzz nightly
for part in "$@"; do
  printf '\n== %s\n' "$part"
  case $part in
    gcc) without_warnings dev -O1 ;;
    clang) without_warnings clang -O0 ;;
    asan | tsan) sanitized "$part" ;;
    words | tidy | fuzz | nightly) "$part" ;;
    *) echo "no such part: $part" >&2; exit 2 ;;
  esac
done
echo "Checked $* in $SECONDS s."
