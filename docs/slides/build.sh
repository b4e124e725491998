#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# build.sh [FOLDER]: makes the slides of the lecture in FOLDER (build/slides): slides.html, one page with everything in it (key P: the
# speaker's view, with notes); slides.pdf; and slides.txt, the notes. Runs the commands in the slides' fences marked sh, which make
# the pictures, in FOLDER/work, and takes the figures from results/reference. Requires gnuplot, npm (which fetches marp) and Chromium.
# RT_PROGRAM: the program (build/release/raytally).
set -euo pipefail
cd "$(dirname "$0")/../.."
root=$PWD program=$(realpath "${RT_PROGRAM:-build/release/raytally}")
mkdir -p "${1:-build/slides}/work/bin" && cd "${1:-build/slides}/work"
ln -sfn "$program" bin/raytally
ln -sfn "$root/scenes" scenes
rm -rf results && mkdir results && cp -r "$root/results/reference" results/ # plots are drawn in the copy

awk '/^```sh$/ { on = 1; next } /^```/ { on = 0 } on' "$root/docs/slides/slides.md" >commands.sh
PATH=$PWD/bin:$PATH bash -euo pipefail commands.sh >commands.log 2>&1 || { tail -n 5 commands.log >&2 && exit 1; }

cp "$root"/docs/slides/{package*.json,marp.config.mjs,slides.css,slides.md} .
npm ci --ignore-scripts --no-audit --no-fund --prefer-offline >npm.log 2>&1 || { tail -n 5 npm.log >&2 && exit 1; }
marp() { node_modules/.bin/marp --config marp.config.mjs --theme slides.css slides.md -o "$1" </dev/null; }
marp ../slides.html
marp ../slides.pdf
marp ../slides.txt
