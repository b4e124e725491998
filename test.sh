#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs missing packages, builds, and runs the tests with gcc and, of shapes, scenes and accelerators, the faster ones under
# the address and undefined-behaviour sanitizers, with kernels for this machine's instruction set. --all: every test and kernel
# with gcc, most of them with clang under these sanitizers and some under the thread sanitizer, with warnings as errors, as
# continuous integration does. At the end it lists tests that no build could run, and their requirements.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

passed=0 failed=0 reports=()

# run_tests PRESET [CTEST OPTION...]: adds to the sums
run_tests() {
    local preset=$1 report=$PWD/build/$1/tests.xml status=0 tests good unrun
    shift
    say "testing build/$preset"
    rm -f "$report"
    # Two more at a time than there are processors: several tests wait for a browser, a timer or a child.
    ctest --preset "$preset" -j $(($(nproc) + 2)) --no-tests=error --timeout 900 --output-junit "$report" \
        --test-output-size-passed 1000000 "$@" || status=1
    count() { grep -c "$1" "$report" 2>/dev/null || true; }
    tests=$(count '<testcase ') good=$(count '<testcase .* status="run"') unrun=$(count '<skipped message="SKIP_')
    passed=$((passed + good))
    [ ! -e "$report" ] || reports+=("$report")
    failed=$((failed + tests - good - unrun))
    [ "$status" = 0 ] || [ "${tests:-0}" != $((${good:-0} + ${unrun:-0})) ] || failed=$((failed + 1)) # no test ran
}

case "${1-}" in
"")
    install_missing build optional data test
    fetch_bunny
    build release -DRT_KERNELS=all
    run_tests release -LE 'slow|more'
    targets=memory_tests build debug -DRT_KERNELS=native
    run_tests debug -L '^(accel|base|scene|scenes|shape|text)$' -LE 'slow|long'
    ;;
--all)
    install_missing build optional data test check cluster package pages
    fetch_bunny
    build release -DRT_KERNELS=all -DRT_WERROR=ON
    run_tests release
    build clang -DRT_WERROR=ON -DRT_DEBUG_INFO=-g1 # lines, for reports of errors
    RT_RAYS=16 run_tests clang -LE 'tree|once|slow'
    targets=thread_tests build tsan -DRT_KERNELS=native -DRT_DEBUG_INFO=-g1
    run_tests tsan -L threads
    ;;
*) die "usage: ./test.sh [--all]" ;;
esac

skipped=$(awk -f tests/skipped.awk "${reports[@]}" </dev/null)
[ -z "$skipped" ] || echo "$skipped"
echo "$passed passed, $failed failed, $(grep -c . <<<"$skipped" || true) skipped"
[ "$failed" = 0 ]
