#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_compare.sh [--clock]: `raytally compare` finds a difference of 2 %, and none between equal programs. raytally_even and
# raytally_slower, beside $RT_PROGRAM, are the same program, but the second needs 2 % more time: --strict must return
# exit code 1, and the reverse comparison must say faster. Of twenty comparisons of a program with itself, of four cells
# each, one may report a difference, as 95 % allow. Times are simulated (tests/cli/compared.c), the same in every run.
# --clock: times are measured, and 2 % of the rays are traced twice, which needs a quiet machine and a release
# build; then three of twenty may report a difference, which more do in less than two of a hundred runs.
set -euo pipefail
programs=$(dirname "$(realpath "${RT_PROGRAM:-build/release/raytally}")")
program=$programs/raytally_even slower=$programs/raytally_slower
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
cd "$work"
allowed=3
[ "${1-}" = --clock ] || {
    export RAYTALLY_TIMES_DRAWN=$work/drawn
    allowed=1
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

rays='--rays primary,random --size 128x128 --limit 16384 --until 0.7% --patience 120'
compare "$program" compare balls --accel bvh $rays --with "$slower" --strict
[ $code = 0 ] && [ "$(grep -c ' faster  ' said)" = 2 ] && grep -q '^2 faster, 0 slower, 0 no difference; counts changed in 0' said ||
    fail '2 % less time are not found'
compare "$slower" compare balls --accel bvh $rays --with "$program" --strict
[ $code = 1 ] && grep -q '^0 faster, 2 slower' said || fail '2 % more time are not found, or not told by the exit code'

# ---- nothing ----

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
reports=0
for seed in {1..20}; do
    sed "1a seed: $seed" null.yaml >seeded.yaml
    compare "$program" compare seeded.yaml --with "$program"
    [ $code = 0 ] || fail 'the program does not compare with itself'
    grep -q '^0 faster, 0 slower, 4 no difference; counts changed in 0' said || {
        reports=$((reports + 1))
        cat said
    }
done
[ $reports -le $allowed ] || fail "$reports of 20 comparisons of the program with itself report a difference"
echo "check_compare: 2 % were found; of 20 comparisons with itself $reports reported a difference"
