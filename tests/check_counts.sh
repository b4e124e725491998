#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_counts.sh [--update]: tests/golden/experiment.yaml reproduces tests/golden/counts.csv, byte for byte, on one thread
# and on two. Run for every build, this makes the counts of compilers and optimisation levels equal. --update
# replaces the file: give the reason in tests/golden/CHANGES.md. Uses $RT_PROGRAM, which must have the kernels of all instruction
# sets; otherwise it is skipped (exit code 77).
set -euo pipefail
cd "$(dirname "$0")/.."
program=${RT_PROGRAM:-build/release/raytally}
golden=tests/golden/counts.csv
! grep -qs '^RT_KERNELS:[A-Z]*=native' "$(dirname "$program")/CMakeCache.txt" || {
    echo "skipped: counts are equal on every machine; needs a build with -DRT_KERNELS=all"
    exit 77
}
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT

run() {
    "$program" run tests/golden/experiment.yaml --threads "$1" --out "$work/$1" >/dev/null 2>"$work/log" || {
        cat "$work/log"
        exit 1
    }
}

if [ "${1-}" = --update ]; then
    run 0 && cp "$work/0/counts.csv" "$golden"
    exit
fi
for threads in 1 2; do
    run $threads
    diff "$golden" "$work/$threads/counts.csv" >"$work/diff" || {
        echo "on $threads threads $(grep -c '^>' "$work/diff") rows differ from $golden:"
        head -n 8 "$work/diff"
        exit 1
    }
done
