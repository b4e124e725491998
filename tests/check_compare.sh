#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_compare.sh [--clock]: `raytally compare` finds a difference of 2 %, and none where there is none. raytally_even and
# raytally_slower, beside $RT_PROGRAM, are the same program, except that the second takes 2 % longer: --strict then ends with
# exit code 1, and the first, compared with it, is faster. Of twenty comparisons of the program with itself, of four cells each,
# at most one may report a difference, as 95 % allow; nor may more than one of twenty pairs of result directories of the program.
# Times are random numbers (tests/cli/compared.c), the same in every run.
# --clock: times are measured, and 2 % of the rays are traced twice; this needs a quiet machine and a release build. Then three
# of twenty may report a difference; more do in less than two of a hundred runs.
set -euo pipefail
programs=$(dirname "$(realpath "${RT_PROGRAM:-build/release/raytally}")")
program=$programs/raytally_even slower=$programs/raytally_slower
work=$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d) && trap 'rm -rf "$work"' EXIT
cd "$work"
allowed=3 size='--size 128x128 --limit 16384'
[ "${1-}" = --clock ] || {
    export RAYTALLY_TIMES_DRAWN=$work/drawn # whatever the rays
    allowed=1 size='--size 32x32'
}

fail() {
    echo "check_compare: $*" >&2
    cat said message >&2
    exit 1
}

compare() {
    code=0
    "$@" >said 2>message || code=$?
}

# ---- 2 % ----

rays="--rays primary,random $size --until 0.7% --patience 120"
compare "$program" compare balls --accel bvh $rays --with "$slower" --strict
[ $code = 0 ] && [ "$(grep -c ' faster  ' said)" = 2 ] && grep -q '^2 faster, 0 slower, 0 with no difference found; counts changed in 0' said ||
    fail '2 % less time are not found'
compare "$slower" compare balls --accel bvh $rays --with "$program" --strict
[ $code = 1 ] && grep -q '^0 faster, 2 slower' said || fail '2 % more time are not found, or not told by the exit code'

# ---- no difference found ----

cat >null.yaml <<'YAML'
name: "null"
question: Is the program faster than itself?
prediction: No.
scenes:
  - {scene: "balls:size=2", size: 32x32, depth: 2}
accelerators: [{accel: bvh}, {accel: grid}]
rays: [primary, random]
limit: 2000
milliseconds: 1
YAML
reports=0 # comparisons that say anything but `0 faster, 0 slower`
compare_alike() { # EXPECTED COMMAND...
    local expected=$1
    compare "${@:2}"
    [ $code = 0 ] || fail 'the program does not compare with itself'
    grep -q "^$expected; counts changed in 0" said || {
        reports=$((reports + 1))
        cat said
    }
}
for seed in {1..20}; do
    sed "1a seed: $seed" null.yaml >seeded.yaml
    compare_alike '0 faster, 0 slower, 4 with no difference found' "$program" compare seeded.yaml --with "$program"
done
[ $reports -le $allowed ] || fail "$reports of 20 comparisons of the program with itself report a difference"

# ---- directories ----

cat >runs.yaml <<'YAML'
name: runs
question: Is a run faster than another one of the same program?
prediction: No.
scenes:
  - {scene: "balls:size=2", size: 32x32, depth: 2}
  - {scene: "tetra:size=2", size: 32x32, depth: 2}
  - {scene: "gears:size=1", size: 32x32, depth: 2}
accelerators: [{accel: bvh}, {accel: grid}, {accel: octree}, {accel: wide}]
rays: [primary, random]
limit: 2000
rounds: 6
milliseconds: 1
YAML
null=$reports reports=0
for pair in {1..20}; do
    "$program" run runs.yaml --out before >message 2>&1 && "$program" run runs.yaml --out after >message 2>&1 || fail 'no runs'
    compare_alike '0 faster, 0 slower, 4 with no difference found' "$program" compare before after --margin 0.1%
    rm -r before after
done
[ $reports -le $allowed ] || fail "$reports of 20 pairs of runs of one program report a difference"
echo "check_compare: 2 % were found; of 20 comparisons with itself $null reported a difference, of 20 pairs of runs $reports"
