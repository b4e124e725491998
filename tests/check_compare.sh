#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_compare.sh: `raytally compare` finds 2 %, and finds nothing where there is nothing. raytally_slower, which lies
# beside $RT_PROGRAM, is the same program but for asking a fiftieth of all rays twice: it is slower, and exit code 1 of
# --strict says so; this one compared with it is faster. Twenty comparisons of the program with itself, of four cells each,
# report a difference as rarely as 95 % allow: each in at most a twentieth of all cases, so more than three of twenty in
# less than two of a hundred. Uses $RT_PROGRAM. Skipped (77) in builds that are not of release.
set -euo pipefail
program=$(realpath "${RT_PROGRAM:-build/release/raytally}")
slower=$(dirname "$program")/raytally_slower
[ -x "$slower" ] || {
    echo 'check_compare: skipped: there is no raytally_slower'
    exit 77
}
grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=Rel' "$(dirname "$program")/CMakeCache.txt" || {
    echo 'check_compare: skipped: times of builds other than release say nothing'
    exit 77
}
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
cd "$work"

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
[ $reports -le 3 ] || fail "$reports of 20 comparisons of the program with itself report a difference"
echo "check_compare: 2 % were found; of 20 comparisons with itself $reports reported a difference"
