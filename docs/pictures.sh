#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# pictures.sh [PAGE.md...]: redraws the pictures of docs/accelerators, the tour and the exercises with the commands beside them in
# the pages (all pages, or those named): each picture by the command that names it. A picture X.svg of a sweep is
# plots/X.svg, or the first plot, of the directory X.
# RT_PROGRAM: the program (build/release/raytally). Exit code 1 if a command fails or draws no picture for a page.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD program=$(realpath "${RT_PROGRAM:-build/release/raytally}")
pages=("$@")
[ $# -gt 0 ] || pages=(docs/accelerators/*.md docs/guide/tour.md docs/guide/teaching.md)

# The drawing commands of a page: only in fences marked sh, since others take long or need meshes.
commands() {
    awk '/^```sh$/ { on = 1; next } /^```/ { on = 0 } on' "$1" | grep -E '^raytally (render|trace|run) ' || true
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
ln -s "$program" "$work/bin/raytally"
for tree in docs experiments scenes; do ln -s "$root/$tree" "$work/$tree"; done
export PATH="$work/bin:$PATH"

status=0
complain() {
    echo "$page: $1"
    status=1
}
for page in "${pages[@]}"; do
    while read -r picture; do
        name=${picture##*/}
        line=$(commands "$page" | grep -E -m 1 -- " ${name%.*}(\.[a-z]+)?( |\$)") || {
            complain "no command makes $name"
            continue
        }
        (cd "$work" && eval "$line" >log 2>&1) || complain "fails: $line"$'\n'"$(cat "$work/log")"
        for made in "$work/$name" "$work/${name%.svg}/plots/$name" "$work/${name%.svg}"/plots/01-*.svg; do
            [ -e "$made" ] && break
        done
        if [ -e "$made" ]; then
            cp "$made" "docs/$picture"
        else
            complain "draws no $name: $line"
        fi
    done < <(grep -oE 'images/(accelerators|tour|teaching)/[a-z0-9.-]+' "$page" | sort -u)
done
exit $status
