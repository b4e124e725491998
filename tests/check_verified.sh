#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_verified.sh [--whole]: results/reference/verify has a thousand million comparisons without a wrong
# answer. One of its scenes, verified again with every tenth accelerator in its manifest (--whole: with all), has the same rows
# (except Embree's, whose own arithmetic differs between processors). A quarter of a minute of processor time. Uses $RT_PROGRAM.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${RT_PROGRAM:-build/release/raytally}
table=results/reference/verify/verify.csv manifest=results/reference/verify/manifest.json
again=$(mktemp -d) && trap 'rm -rf "$again"' EXIT

# sum COLUMN: quoted fields have commas
sum() {
    sed 's/"[^"]*"/quoted/g' "$table" | awk -F, -v name="$1" '
        NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) column = i; next }
        { sum += $column }
        END { printf "%.0f\n", sum }'
}
# setting NAME: a setting of the run
setting() { sed -n "s/^  \"$1\": \([0-9]*\),$/\1/p" "$manifest"; }

echo "$(sum rays) pairs, $(sum wrong) wrong"
[ "$(sum rays)" -ge 1000000000 ]
[ "$(sum wrong)" = 0 ]
grep -q "^$(sum rays) comparisons" results/reference/verify/verify.md

# Skips accelerators that need instructions this processor lacks.
absent=no-such-instructions every=10
! grep -q 'this processor has no avx512' <<<"$("$program" verify tetra --rays 1 --accel wide:isa=avx512 2>&1)" || absent=isa=avx512
[ "${1-}" != --whole ] || every=1
mapfile -t accels < <(sed -n '/^  "accels": \[/,/^  \]/s/^    "\(.*\)",\{0,1\}$/\1/p' "$manifest" |
    grep -v -e '^embree' -e "$absent" | sed -n "1~${every}p")
scene="family:kind=csg-far,seed=$(setting seed)"
"$program" verify "$scene" "${accels[@]/#/--accel=}" --rays "$(setting rays)" --seed "$(setting seed)" --out "$again" >/dev/null
rows=$(printf "\"$scene\",%s,\n" "${accels[@]}" | grep -Ff - "$table")
[ "$(wc -l <<<"$rows")" = ${#accels[@]} ]
if grep -vxFf "$again/verify.csv" <<<"$rows"; then
    echo "these rows of $table are other ones when $scene is verified again"
    exit 1
fi
