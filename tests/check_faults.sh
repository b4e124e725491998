#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_faults.sh: each line of tests/faults/faults.tsv applies: its text occurs exactly once in its file, its accelerators exist,
# and the changed file compiles (parsed alone, with the flags of the build by ninja beside $RT_PROGRAM; without one this is not
# checked). There are at least 60 faults, and at least one for each registered accelerator.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(dirname "${RT_PROGRAM:-build/release/raytally}")
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
failures=0 names= layers=
registered=$(sed -n 's/^const RtAccelOps rt_\([a-z]*\)_ops = {.*/\1/p' accel/*.c accel/*/*.c)
report() {
    echo "$*"
    failures=$((failures + 1))
}

# The objects of the program that each file is compiled into: OBJECT<tab>FILE.
[ ! -e "$build/build.ninja" ] || ninja -C "$build" -t deps | awk -v tree="$PWD/" '
    /^[^ ]/ { object = $1; sub(/:$/, "", object) }
    /^ / && object ~ /raytally/ { sub(/^ *(\.\.\/)*/, ""); sub("^" tree, ""); print object "\t" $0 }' >"$work/objects"

# compiles FILE: $work/FILE does, in the place of FILE; gcc and clang look for included files there first
compiles() {
    local object command source=$1
    object=$(awk -F '\t' -v file="$1" '$2 == file { print $1; exit }' "$work/objects")
    command=$(ninja -C "$build" -t commands -s "$object" | tail -n 1)
    if [ "${1##*.}" = c ]; then source=$work/$1; else source=${command##* -c }; fi
    command=${command%% -MD *} command=${command#*ccache }
    eval "${command/ / -I "$work" }" -Wno-error -Werror=implicit-function-declaration -fsyntax-only "$source"
}

while IFS=$'\t' read -r name accels kind file text instead meaning _; do
    [ -n "$meaning" ] || report "$name: a fault has seven fields and, if verify misses it, an eighth that says why ($kind)"
    source=$(cat "$file") || source=
    if [[ $source != *"$text"* ]]; then
        report "$name: $file does not contain: $text"
    elif [[ ${source/"$text"/} = *"$text"* ]]; then
        report "$name: $file contains more than once: $text"
    elif [ -e "$work/objects" ]; then
        mkdir -p "$work/${file%/*}" && printf '%s\n' "${source/"$text"/"$instead"}" >"$work/$file"
        compiles "$file" 2>"$work/log" || report "$name: $file does not compile with: $instead: $(grep -m 1 error "$work/log")"
        rm "$work/$file"
    fi
    [ "$text" != "$instead" ] || report "$name changes nothing"
    names+=$name$'\n'
    for accel in ${accels//+/ }; do layers+=${accel%%:*}$'\n'; done
done < <(grep -v '^#' tests/faults/faults.tsv)
sort <<<"$names" | uniq -d | grep . && report "faults have names of their own"
sort -u <<<"$layers" | grep -vxF -e '' -e "$registered" && report "these are no accelerators"
sort -u <<<"$registered" | grep -vxF "$layers" && report "these accelerators have no fault"
[ "$(wc -l <<<"$names")" -gt 60 ] || report "there are fewer than 60 faults"
[ "$failures" -eq 0 ]
