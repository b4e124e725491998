#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Reports, the index and the explorer in headless Chromium: tables sort and filter, nothing is cut off at any width or in
# print, no page makes a request, the console stays empty, 10,112 cells are under 12 MB and usable, the explorer counts what
# `trace` counts, and axe (through npm) finds nothing serious. Skipped without Chromium, its driver or node, and without axe or
# the explorer if npm cannot install what they need.
set -euo pipefail
program=$(realpath "${RT_PROGRAM:?the path of raytally}")
here=$(realpath "$(dirname "$0")")
for needed in chromium chromedriver node; do
    command -v "$needed" >/dev/null || {
        echo "skipped: reports in a browser; needs $needed (./test.sh --all installs it)"
        exit 77
    }
done
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
cd "$work"

# yaml NAME SCENES ACCELERATORS RAYS
yaml() {
    printf '%s\n' "name: $1" 'question: Which is cheaper?' 'prediction: The hierarchy <b>is</b>.' "scenes: [$2]" \
        "accelerators: [$3]" "rays: [$4]" 'limit: 40' 'rounds: 2' 'milliseconds: 0' \
        'finding: "It {was: object_tests of bvh > 1000}, by {object_tests of bvh}."' 'not_shown: Time.' \
        'expect: ["object_tests of bvh < 1000", "object_tests of bvh > 1000", "time of bvh < 1"]' >"$1.yaml"
    "$program" run "$1.yaml" --out "results/$1" --threads 1 >"$1.log" 2>&1 || { cat "$1.log" && exit 1; }
}
yaml small '{scene: "balls:size=2", size: 24x24, label: balls}, {scene: "random:n=50..200*2", size: 16x16, label: cloud}' \
    '{accel: brute}, {accel: bvh}, {accel: "grid:density=1..16*2"}' 'primary, shadow, diffuse, random'
yaml large '{scene: "random:n=20..51+1", size: 6x6, label: cloud}' '{accel: bvh}, {accel: "grid:density=1..78+1"}' \
    'primary, shadow, diffuse, random'
"$program" report --index results >/dev/null

axe=()
cp "$here"/pages/package*.json .
if npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1; then
    axe=(node_modules/axe-core/axe.min.js)
else
    echo "check_pages: without axe, which npm did not bring: $(tail -n 1 npm.log)"
fi
node "$here/pages/check_pages.mjs" results/small/report.html results/large/report.html results/index.html "${axe[@]}"
if "$program" explore balls:size=1 --size 2x2 -o walk.html >explore.log 2>&1; then
    node "$here/pages/check_explorer.mjs" "$program" "${axe[@]}"
else
    echo "check_pages: without the explorer: $(cat explore.log)"
fi
