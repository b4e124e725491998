#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# pictures.sh [PAGE.md...]: redraws the pictures of docs/accelerators with the commands beside them in the
# pages (all pages, or those named). A picture X.svg of a sweep is plots/X.svg, or the first plot, of the directory X.
# RT_PROGRAM: the program (build/release/raytally). Exit code 1 if a command fails or draws no picture for a page.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD program=$(realpath "${RT_PROGRAM:-build/release/raytally}")
pages=("$@")
[ $# -gt 0 ] || pages=(docs/accelerators/*.md)

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
for page in "${pages[@]}"; do
    while read -r line; do
        (cd "$work" && eval "$line" >log 2>&1) || {
            echo "$page: fails: $line"
            cat "$work/log"
            status=1
        }
    done < <(commands "$page")
    while read -r name; do
        for made in "$work/$name" "$work/${name%.svg}/plots/$name" "$work/${name%.svg}"/plots/01-*.svg; do
            [ -e "$made" ] && break
        done
        if [ -e "$made" ]; then
            cp "$made" "docs/images/accelerators/$name"
        else
            echo "$page: no command makes $name"
            status=1
        fi
    done < <(grep -oE 'images/accelerators/[a-z0-9.-]+' "$page" | sed 's|.*/||' | sort -u)
done
exit $status
