#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# compare_meshes.sh FOLDER...: reads every mesh file below the folders with raytally and with Assimp (`assimp`, of assimp-utils), and
# compares triangles, box, area and volume. Assimp's triangles come as binary STL. Prints a line for each file that differs or
# that only one of them reads, what raytally says of it, and how many of each there are. For use by hand: no test needs it.
# Uses $RT_PROGRAM.
set -uo pipefail
program=$(realpath "${RT_PROGRAM:-build/release/raytally}")
command -v assimp >/dev/null || { echo "compare_meshes: needs assimp (assimp-utils)" >&2 && exit 2; }
[ $# -gt 0 ] || { echo "usage: tests/compare_meshes.sh FOLDER..." >&2 && exit 2; }
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
patience=120

# measures FILE: its triangles, box, area and volume, on one line; nothing if raytally cannot read it
measures() {
    timeout "$patience" "$program" info "$1" --json 2>"$work/said" | python3 -c '
import json, sys
i = json.load(sys.stdin)
print(i["shapes"]["triangle"], *i["bounds"]["lo"], *i["bounds"]["hi"], i["area"], i["volume"])' 2>/dev/null
}

# alike OURS THEIRS: up to rounding: lengths by 1e-5 of the box, areas and volumes by 1e-4 of what such a box may have
alike() {
    awk -v ours="$1" -v theirs="$2" 'BEGIN {
        split(ours, a, " "); split(theirs, b, " ")
        for (k = 2; k <= 4; k++) size += (a[k + 3] - a[k]) ^ 2
        size = sqrt(size)
        if (a[1] != b[1]) what = what " triangles " a[1] " " b[1]
        for (k = 2; k <= 7; k++) if ((a[k] - b[k]) ^ 2 > (1e-5 * size) ^ 2) { what = what " box"; break }
        if ((a[8] - b[8]) ^ 2 > (1e-4 * a[8]) ^ 2) what = what " area " a[8] " " b[8]
        if ((a[9] - b[9]) ^ 2 > (1e-4 * size ^ 3) ^ 2) what = what " volume " a[9] " " b[9]
        print what
        exit what != ""
    }'
}

declare -A counts
while IFS= read -r file; do
    ours=$(measures "$file")
    said=$(grep -v '^raytally: warning' "$work/said" | head -n 1)
    warnings=$(grep -c '^raytally: warning' "$work/said")
    rm -f "$work/theirs.stl"
    timeout "$patience" assimp export "$file" "$work/theirs.stl" -fstlb -tri >/dev/null 2>&1
    theirs=
    [ ! -s "$work/theirs.stl" ] || theirs=$(measures "$work/theirs.stl")
    if [ -n "$ours" ] && [ -n "$theirs" ]; then
        kind=alike
        what=$(alike "$ours" "$theirs") || kind=differs
    elif [ -n "$ours" ]; then
        kind='raytally alone' what=
    elif [ -n "$theirs" ]; then
        kind='Assimp alone' what=" $said"
    else
        kind=neither what=" $said"
    fi
    [ "$warnings" = 0 ] || what+=" ($warnings warnings)"
    counts[$kind]=$((${counts[$kind]:-0} + 1))
    [ "$kind" = alike ] || echo "$kind: $file:$what"
done < <(find "$@" -type f \( -iname '*.obj' -o -iname '*.ply' -o -iname '*.stl' -o -iname '*.off' -o -iname '*.gltf' -o -iname '*.glb' \) | sort)
for kind in "${!counts[@]}"; do echo "${counts[$kind]} $kind"; done
