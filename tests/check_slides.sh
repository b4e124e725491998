#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The slides of the lecture, docs/slides: they build, every figure is in the named result, and in headless Chromium every slide has
# a heading, a picture with alternative text and notes, is readable, overflows nowhere and makes no request. Skipped without
# Chromium, its driver, gnuplot, node or npm, or if npm cannot install marp.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$(dirname "$0")/.."
skip() {
    echo "skipped: the slides; $1"
    exit 77
}
for needed in chromium chromedriver gnuplot node npm; do
    command -v "$needed" >/dev/null || skip "needs $needed (./test.sh --all installs it)"
done

RT_PROGRAM=$program docs/slides/build.sh "$work/slides" >"$work/log" 2>&1 || {
    [ ! -s "$work/slides/work/npm.log" ] || [ -x "$work/slides/work/node_modules/.bin/marp" ] || skip "npm cannot install marp"
    cat "$work/log" && exit 1
}
node tests/pages/check_slides.mjs "$work/slides" docs/slides/slides.md || complain "the slides are not as they should be"

# fails SLIDE SAYING: marp makes no slides of this one
cd "$work/slides/work"
fails() {
    printf '%s\n' "$1" >one.md
    if node_modules/.bin/marp --config marp.config.mjs one.md -o one.html >said 2>&1 </dev/null ||
        ! tr -s '[:space:]' ' ' <said | grep -qE "$2"; then # marp breaks lines
        complain "'$1' should fail and say '$2': $(cat said)"
    fi
}
fails '{{first-look/frame ms scene=bunny accel=none}}' 'names 0 rows'
fails '{{first-look/frame ms scene=bunny}}' 'names [1-9][0-9]+ rows'
fails '{{first-look/frame mss scene=bunny accel=grid}}' 'has no value'
fails '{{no-experiment/frame ms scene=bunny accel=grid}}' 'no-experiment'
fails '![x](none.svg)' 'none.svg'
conclude
