#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_verified.sh: results/verify has a thousand million pairs of a ray and an accelerator without a wrong answer. One
# of its scenes, verified again with the accelerators in its manifest, has the same rows (except Embree's,
# whose own arithmetic differs between processors). Two minutes of processor time. Uses $RT_PROGRAM.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${RT_PROGRAM:-build/release/raytally}
table=results/verify/verify.csv manifest=results/verify/manifest.json
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

# Skips accelerators that need instructions this processor lacks.
absent=no-such-instructions
! grep -q 'this processor has no avx512' <<<"$("$program" verify tetra --rays 1 --accel wide:isa=avx512 2>&1)" || absent=isa=avx512
# accels: the accelerators of the run, as options
accels() { sed -n '/^  "accels": \[/,/^  \]/s/^    "\(.*\)",\{0,1\}$/--accel \1/p' "$manifest" | grep -v "$absent"; }

echo "$(sum rays) pairs, $(sum wrong) wrong"
[ "$(sum rays)" -ge 1000000000 ]
[ "$(sum wrong)" = 0 ]
grep -q "^$(sum rays) pairs of a ray and an accelerator" results/verify/verify.md

scene="family:kind=csg-far,seed=$(setting seed)"
# shellcheck disable=SC2046 # options and their values are words of their own
"$program" verify "$scene" $(accels) --rays "$(setting rays)" --seed "$(setting seed)" --out "$again" >/dev/null
rows=$(grep -F "\"$scene\"," "$table" | grep -v -e '",embree' -e "$absent")
[ "$(wc -l <<<"$rows")" -gt 10 ]
if grep -vxFf "$again/verify.csv" <<<"$rows"; then
    echo "these rows of $table are other ones when $scene is verified again"
    exit 1
fi
