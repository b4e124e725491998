#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# differences.sh [RUNS]: does a table find differences where there are none (A/A), and does it find small ones (A/B)? Measures, so it
# needs a quiet machine and a release build, and is no test of CI, where test_paired simulates the same. Uses $RT_PROGRAM.
#
# A/A: twenty copies of bvh under other labels, over five scenes, in each of RUNS runs (20). False is a ratio whose interval excludes 1.
# Copies that are compared with one baseline share its luck: where it was slow, all are faster. So copies are compared in pairs, ten a
# scene, each copy in one pair; and as kinds of rays share the copies of a round, and where these lie, a pair has one kind, by turns.
# The draws are then independent, and the number of false ones is binomial. It fails if so many or more had a chance below 1 %.
#
# A/B: bvh_late, a plugin that traces every 33rd ray twice, against bvh_copy, the same without, in as many runs. It fails unless the
# slower is found slower in nine of ten cells with 60 rounds; the first n rounds show what n find.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$work"
runs=${1:-20}
most=60 power=0.9
scenes=(random:n=2000 random:n=300 balls:size=3 tetra:size=4 gears:size=2)

# experiment NAME SEED ROUNDS BASELINE ACCELERATOR...
experiment() {
    printf '%s\n' "name: $1" 'question: Which is faster?' 'prediction: The first.' "seed: $2" "rounds: $3" "baseline: $4" \
        'milliseconds: 2' 'rays: [primary, shadow, diffuse]' 'scenes:'
    printf '  - {scene: "%s", size: 96x96, depth: 2}\n' "${scenes[@]}"
    echo 'accelerators:'
    printf '  - {%s}\n' "${@:5}"
}

# measured NAME RUN OPTION...: NAME.yaml, to NAME-RUN
measured() {
    "$program" run "$1.yaml" --out "$1-$2" --threads 1 "${@:3}" >log 2>&1 || { cat log && exit 2; }
}

# What the interval of a table is (src/measure/statistics.h): the k-th smallest to the k-th largest ratio of n.
rules='
function choose_below(n, k,   i, term, sum) { # P(Binomial(n, 1/2) < k)
    term = 0.5 ^ n
    for (i = 0; i < k; i++) { sum += term; term *= (n - i) / (i + 1) }
    return sum
}
function rank_of(n,   k) {
    k = 1
    while (1 - 2 * choose_below(n, k + 1) >= 0.95) k++
    return k
}
function log_factorial(n,   sum) { for (; n > 1; n--) sum += log(n); return sum }
function tail(least, n, p,   i, sum) { # P(Binomial(n, p) >= least)
    for (i = least; i <= n; i++)
        sum += exp(log_factorial(n) - log_factorial(i) - log_factorial(n - i) + i * log(p) + (n - i) * log(1 - p))
    return sum
}
{ gsub(/"[^"]*"/, "quoted") }
FNR == 1 { for (i in column) delete column[i]; for (i = 1; i <= NF; i++) column[$i] = i; next }
'

failed=0

# ---- A/A ----

for run in $(seq "$runs"); do
    experiment copies "$run" 10 copy-1 'accel: bvh, label: copy-'{1..20} >copies.yaml
    measured copies "$run"
done
awk -F, "$rules"'
{
    directory = FILENAME; sub(/\/.*/, "", directory)
    cell = directory SUBSEP $column["scene"] SUBSEP $column["kind"]
    accel = $column["accel"]
}
FILENAME ~ /times.csv$/ {
    if (accel == "copy-2") table[cell] = $column["ratio_low"] > 1 || $column["ratio_high"] < 1
    next
}
accel ~ /^copy-[0-9]+$/ { time[cell, substr(accel, 6), $column["round"]] = $column["round_ns"]; cells[cell] }
function differs(cell, a, b,   r, above, below) {
    for (r = 1; r <= 10; r++) { above += time[cell, a, r] > time[cell, b, r]; below += time[cell, a, r] < time[cell, b, r] }
    return above <= rank_of(10) - 1 || below <= rank_of(10) - 1
}
END {
    kinds[0] = "primary"; kinds[1] = "shadow"; kinds[2] = "diffuse"
    for (cell in cells) {
        split(cell, part, SUBSEP)
        if (differs(cell, 1, 2) != table[cell]) { print "the table does not say what the rounds say: " part[1], part[2], part[3]; exit 1 }
        for (pair = 1; pair <= 10; pair++) {
            if (part[3] != kinds[(pair + substr(part[1], 8)) % 3]) continue
            count++
            false += differs(cell, 2 * pair - 1, 2 * pair)
        }
    }
    stated = 2 * choose_below(10, rank_of(10))
    chance = tail(false, count, stated)
    printf "A/A: %d of %d pairs of copies differ, %.1f %%; stated: %.1f %%; the chance of so many or more: %.3f\n", false, count,
        100 * false / count, 100 * stated, chance
    exit chance < 0.01
}' copies-*/rounds.csv copies-*/times.csv || failed=1

# ---- A/B ----

for run in $(seq "$runs"); do
    experiment late "$run" "$most" bvh_copy 'accel: bvh_copy' 'accel: bvh_late' >late.yaml
    measured late "$run" --plugin "$(dirname "$program")/plugins/bvh_copy.so" --plugin "$(dirname "$program")/plugins/bvh_late.so"
done
awk -F, -v most="$most" -v power="$power" "$rules"'
$column["accel"] == "bvh_late" {
    cell = FILENAME SUBSEP $column["scene"] SUBSEP $column["kind"]
    ratio[cell, $column["round"]] = $column["round_ns"] / $column["round_baseline_ns"]
    cells[cell]
}
END {
    for (cell in cells) { count++; for (r = 1; r <= most; r++) { sum += log(ratio[cell, r]) } }
    printf "A/B: %.1f %% slower, in %d cells; found slower:", 100 * (exp(sum / count / most) - 1), count
    for (n = 10; n <= most; n += 10) {
        found = wrong = 0
        for (cell in cells) {
            below = above = 0
            for (r = 1; r <= n; r++) { below += ratio[cell, r] <= 1; above += ratio[cell, r] >= 1 }
            found += below < rank_of(n)
            wrong += above < rank_of(n)
        }
        printf "%s %.0f %% with %d rounds", (n > 10 ? "," : ""), 100 * found / count, n
        if (wrong) printf " (and %d found faster)", wrong
    }
    print ""
    exit found < power * count
}' late-*/rounds.csv || failed=1

[ $failed = 0 ] && echo 'both are as stated' || echo 'NOT as stated' >&2
exit $failed
