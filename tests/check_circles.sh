#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_circles.sh [TREE]: no files in a circle, and no room that needs one above it. A file needs another where its
# object file, among those beside $RT_PROGRAM, needs a symbol that the other's defines, and a header another where it
# includes it. Prints each circle and each need that points up, with the symbols, and fails where there is one. Exit
# code 77 where there is no `nm` to read object files with.
set -euo pipefail
tests=$(cd "$(dirname "$0")" && pwd)
build=$(dirname "${RT_PROGRAM:?the path of raytally, beside which the object files lie}")
build=$(cd "$build" && pwd)
command -v nm >/dev/null || { echo "skipped: no two files call each other; needs binutils"; exit 77; }
cd "${1:-$tests/..}"

# The objects whose sources are still there: a build keeps those of files that are gone.
objects() {
    find "$build/CMakeFiles" -path '*/raytally*.dir/*.c.o' | sort | while read -r object; do
        source=${object#"$build"/CMakeFiles/raytally*.dir/}
        if [ -f "${source%.o}" ]; then echo "$object"; fi
    done
}

# "FILE TYPE SYMBOL" of their global symbols, and "FILE FILE #include" of every header that includes another; all
# without the src/ before them.
# shellcheck disable=SC2016 # the dollars are awk's
needs() {
    objects | xargs nm -A -g |
        sed -n 's|^.*/raytally[a-z_]*\.dir/\(src/\)*\(.*\)\.o:.* \([A-Za-z]\) \(r[a-z]*_[^ ]*\)$|\2 \3 \4|p'
    find src accel scenes tests -name '*.h' | sort | xargs -r awk '
        /^[ \t]*#[ \t]*include[ \t]*"/ {
            split($0, quoted, "\"")
            from = FILENAME
            sub(/^src\//, "", from)
            home = from
            sub(/[^\/]*$/, "", home)
            print from, quoted[2] ~ /\// ? quoted[2] : home quoted[2], "#include"
        }'
}

[ -n "$(objects)" ] || { echo "there are no object files of this tree in $build: build it first"; exit 1; }

# shellcheck disable=SC2016 # the dollars are awk's
needs | awk -v rooms="$(cat "$tests/rooms.txt")" '
    BEGIN {
        rooms_count = split(rooms, list, " ")
        for (i = 1; i <= rooms_count; i++) level[list[i]] = i
    }
    function level_of(path,    part) {
        sub(/^core\//, "", path)
        split(path, part, "/")
        return level[part[1]]
    }
    function need(from, to, what) {
        if (from == to) return
        if (!((from, to) in why)) needs[from] = needs[from] " " to
        why[from, to] = why[from, to] " " what
    }
    # Depth first: a file that is met again on the way to itself closes a circle.
    function visit(file,    others, count, i, k) {
        state[file] = "on the way"
        way[++depth] = file
        count = split(needs[file], others, " ")
        for (i = 1; i <= count; i++) {
            if (!(others[i] in state)) visit(others[i])
            if (state[others[i]] != "on the way") continue
            print "a circle of files:"
            for (k = depth; way[k] != others[i]; k--) continue
            for (; k <= depth; k++) tell(way[k], k < depth ? way[k + 1] : others[i])
        }
        depth--
        state[file] = "done"
    }
    function tell(from, to) {
        print "    " from " needs " to ":" why[from, to]
        wrong = 1
    }
    $3 == "#include" { need($1, $2, $3) }
    $2 ~ /^[TDBRC]$/ { home[$3] = $1 }
    $2 == "U" { user[++uses] = $1; used[uses] = $3 }
    { if (!($1 in seen)) { seen[$1] = 1; files[++file_count] = $1 } }
    END {
        for (i = 1; i <= uses; i++) if (used[i] in home) need(user[i], home[used[i]], used[i])
        for (pair in why) {
            split(pair, ends, SUBSEP)
            if (level_of(ends[2]) <= level_of(ends[1])) continue
            print "a room that needs one above it:"
            tell(ends[1], ends[2])
        }
        for (i = 1; i <= file_count; i++) if (!(files[i] in state)) visit(files[i])
        exit wrong
    }'
