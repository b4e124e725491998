#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# How often does the interval of a ratio miss 1 when both structures are the same? Measures pairs of equal
# structures, 36 in each of RUNS runs (20), and prints the share of misses beside the one that 10 rounds
# promise, 2.1 %. Takes about 10 s a run; not part of the tests, because it depends on the machine.
#
#     tests/null_runs.sh PROGRAM [RUNS]
set -eu
program=$(realpath "$1")
runs=${2:-20}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"

for run in $(seq "$runs"); do
    {
        printf 'name: nulls\nquestion: Are equal structures equally fast?\nprediction: They are.\nseed: %s\n' "$run"
        printf 'rays: [primary, shadow, reflection]\nrounds: 10\nmilliseconds: 2\nbaseline: bvh-1\nscenes:\n'
        printf '  - {scene: "%s", size: 96x96, depth: 3}\n' random:n=2000 random:n=300 balls
        printf 'accelerators:\n'
        printf '  - {accel: %s, label: %s-%s}\n' bvh bvh 1 bvh bvh 2 bvh bvh 3 bvh bvh 4 octree octree 1 \
            octree octree 2 grid grid 1 grid grid 2
    } >nulls.yaml
    "$program" run nulls.yaml --out "run-$run" >log 2>&1 || { cat log; exit 2; }
done

# Pairs of labels N-1 and N-2, N-3 and N-4; the interval of 10 rounds is from the 2nd smallest to the 2nd largest.
awk -F, '
FNR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
$column["accel"] !~ /again/ {
    label = $column["accel"]
    number = substr(label, length(label))
    half = number % 2
    pair = FILENAME "," $column["scene"] "," $column["kind"] "," substr(label, 1, length(label) - 1) int((number + 1) / 2)
    time[pair, half, $column["round"]] = $column["round_ns"]
    pairs[pair] = 1
}
END {
    for (pair in pairs) {
        below = above = 0
        for (r = 1; r <= 10; r++) {
            below += time[pair, 1, r] < time[pair, 0, r]
            above += time[pair, 1, r] > time[pair, 0, r]
        }
        low += above <= 1
        high += below <= 1
        count++
    }
    printf "%d pairs: %d intervals below 1, %d above, %.1f %% (2.1 %% to be expected)\n", count, low, high,
        100 * (low + high) / count
}' run-*/rounds.csv
