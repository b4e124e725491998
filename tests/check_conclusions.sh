#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_conclusions.sh: experiments that would mislead, one for each kind of fault: the program refuses, marks or corrects each. Of one
# kind it knows nothing: structures whose code differs by more than the idea that is compared. Uses $RT_PROGRAM.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$work"

# experiment LINE...: what the lines leave open is small, and counted alone
experiment() {
    local key rest
    {
        printf '%s\n' "$@"
        while read -r key rest; do
            printf '%s\n' "$@" | grep -q "^$key" || echo "$key $rest"
        done <<'END'
name: doubtful
question: Does the program see what is wrong with it?
prediction: It does.
scenes: [{scene: "balls:size=2", label: balls, size: 64x64, depth: 2}, {scene: "random:n=300", label: cloud, size: 64x64, depth: 2}]
accelerators: [{accel: bvh}, {accel: grid}]
rays: [primary, shadow]
limit: 2000
rounds: 6
milliseconds: 0
builds: 1
END
    } >doubtful.yaml
}

# concludes CODE PATTERN...: `run --strict` ends with CODE and says each, or its report does
concludes() {
    local pattern
    rm -rf out
    ends "$1" run doubtful.yaml --strict --threads 1 --out out
    last="run of $(tr '\n' ' ' <doubtful.yaml)"
    for pattern in "${@:2}"; do says "$pattern"; done
}

# ---- a default against a tuned setting ----

experiment 'accelerators: [{accel: octree}, {accel: "octree:best"}, {accel: bvh}]' \
    'expect: ["ratio of time of octree to octree:best on cloud for primary rays"]'
concludes 0 'octree:best, chosen by other rays: octree.* .primary' 'figure +ratio of time of octree to octree:best'
[ "$(grep -c ',primary,.*,octree:best,' out/times.csv)" = 2 ] || complain 'the best setting has no row in times.csv'
! grep -q 'octree:best' out/counts.csv && [ "$(grep -c ',primary,.*,octree-' out/counts.csv)" -ge 6 ] ||
    complain 'counts.csv is not that of all settings that were tried'

# ---- builds and rays on unlike threads ----

# brute has nothing to build, and is far slower: no noise hides either.
experiment 'accelerators: [{accel: bvh}, {accel: brute}]' 'expect: ["break_even of brute on cloud > 1"]' \
    'scenes: [{scene: "random:n=3000", label: cloud, size: 64x64, depth: 2}]'
concludes 0 'faster up to' 'holds +break_even of brute'
sed -i 's/\("timed":.*"threads":\)1/\12/' out/cells.jsonl # as before there was one number of threads
ends 0 report out
says 'undecided +break_even of brute'
ends 0 run doubtful.yaml --resume --threads 1 --out out
says_not 'faster (up to|from)'

# ---- kinds of rays in one figure ----

# A light buffer has fewer extent tests for shadow rays alone.
buffers='accelerators: [{accel: bvh}, {accel: light+bvh}]'
experiment 'count_only: yes' "$buffers" 'expect: ["ratio of extent_tests of light+bvh to bvh on cloud < 1"]'
concludes 1 'does not hold +ratio of extent_tests of light.bvh to bvh on cloud < 1 +1.00 .light.bvh on cloud, primary rays'
experiment 'count_only: yes' "$buffers" 'finding: "On the cloud {it saves tests: ratio of extent_tests of light+bvh to bvh on cloud < 1}."'
concludes 1 'it saves tests .does not hold.'

# ---- a set of rays that is learnt by heart ----

experiment 'scenes: [{scene: "random:n=1000", label: few, size: 64x64, depth: 1}]' 'rays: [random]' 'limit: 200' 'milliseconds: 5' 'rounds: 10' \
    'accelerators: [{accel: bvh}, {accel: grid}, {accel: kd}]'
concludes 0 'Too few rays. They take longer with other rays .*200 random rays .*learnt them, so the times are too short'

# ---- a correlation that is only one between scenes ----

# In each scene finer grids have fewer tests and more steps; larger scenes have more of both.
experiment 'count_only: yes' 'scenes: [{scene: "random:n=100..10000*10", label: r, size: 32x32, depth: 2}]' \
    'accelerators: [{accel: "grid:density=0.5..32*2", label: grid}]' 'expect: ["correlation of object_tests and steps of grid > 0"]'
concludes 1 'does not hold +correlation of object_tests and steps of grid > 0 +-1.00 '

# ---- digits that are not those of the data ----

experiment 'count_only: yes' 'finding: "bvh takes 1.4 times as many tests."'
concludes 0 "finding: '1.4' stands outside braces"
experiment 'count_only: yes' 'finding: "It has {7 times as many tests: ratio of object_tests of bvh to grid < 1}."'
concludes 2 "'7' is not the number of the claim"
experiment 'count_only: yes' 'finding: "bvh needs {more tests: ratio of object_tests of bvh to grid > 1}."'
concludes 1 'more tests .does not hold.'

# ---- general words with restrictions that are hidden ----

experiment 'count_only: yes' 'finding: "bvh always needs fewer tests."'
concludes 0 "finding: 'always' "
experiment 'count_only: yes' 'finding: "It {always needs fewer tests: ratio of object_tests of bvh to grid on balls < 1}."'
concludes 2 "'always needs fewer tests' are general, and the claim is only about 'balls'"
experiment 'count_only: yes' 'finding: "It is {the fastest everywhere: bvh has least steps}."'
concludes 1 'the fastest everywhere .does not hold.'

# ---- papers that are confirmed by nothing ----

# paper TEXT
paper() {
    experiment 'count_only: yes' "paper: {citation: Nobody 1980, quote: It is faster., verdict: confirmed, $1}"
}
holding='expect: ["ratio of object_tests of bvh to grid < 1"]'
paper 'page: "1"'
concludes 1 "'confirmed' needs .modelled." "not supported +'confirmed' for Nobody 1980: it names no claims"
paper 'page: "1", modelled: by bvh'
concludes 1 "this verdict needs .expect." "not supported +'confirmed' for Nobody 1980: it names no claims"
paper "page: \"1\", $holding"
concludes 1 "not supported +'confirmed' for Nobody 1980: it does not say how the paper's configuration is modelled"
paper 'page: "1", modelled: by bvh, expect: ["ratio of object_tests of bvh to grid > 9"]'
concludes 1 "not supported +'confirmed' for Nobody 1980: not all of its claims hold"
paper "page: unseen, modelled: by bvh, $holding"
concludes 1 "not at hand .page: unseen. has the verdict 'not tested'" "not supported +'confirmed' for Nobody 1980: the paper was not at hand"
paper "page: \"1\", modelled: by bvh, $holding"
concludes 0 'holds +ratio of object_tests of bvh to grid < 1'
says_not 'not supported'

conclude
