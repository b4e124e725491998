#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_circles.sh [TREE]: no circular dependencies between files. A file needs another if its object file, among those beside
# $RT_PROGRAM, needs a symbol that the other's defines; a header needs another if it includes it. Prints the files of
# each circle; exit code 1 if there is one, 77 without `nm` to read object files.
set -euo pipefail
build=$(cd "$(dirname "${RT_PROGRAM:?the path of raytally, beside which the object files lie}")" && pwd)
command -v nm >/dev/null || { echo "skipped: no two files call each other; needs binutils" && exit 77; }
cd "${1:-$(dirname "$0")/..}"

# "FILE.c TYPE SYMBOL" of global symbols, if FILE.c still exists: a build keeps the objects of deleted files.
symbols=$(find "$build/CMakeFiles" -path '*/raytally*.dir/*.c.o' -exec nm -A -g {} + |
    sed -n 's|^.*/raytally[a-z_]*\.dir/\(.*\)\.o:.* \([A-Za-z]\) \(r[a-z]*_[^ ]*\)$|\1 \2 \3|p' |
    while read -r file rest; do [ ! -f "$file" ] || echo "$file $rest"; done)
[ -n "$symbols" ] || { echo "there are no object files of this tree in $build: build it first" && exit 1; }

# shellcheck disable=SC2016 # the dollars are awk's
{
    awk '$2 ~ /^[TDBRC]$/ { home[$3] = $1 }
         $2 == "U" { user[++uses] = $1; used[uses] = $3 }
         END { for (i = 1; i <= uses; i++) if (used[i] in home) print user[i], home[used[i]] }' <<<"$symbols"
    find src accel scenes tests -name '*.h' -print0 | xargs -0r awk '/^[ \t]*#[ \t]*include[ \t]*"/ {
        split($0, quoted, "\"")
        from = home = FILENAME
        sub(/^src\//, "", from)
        sub(/[^\/]*$/, "", home)
        sub(/^src\//, "", home)
        print from, quoted[2] ~ /\// ? quoted[2] : home quoted[2]
    }'
} | tsort >/dev/null
