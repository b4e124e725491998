#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_interface.sh: the public headers keep interface 1 (docs/interface.md). They compile with its record,
# tests/library/interface_1.txt, with every available compiler, and the record names every function, type and enumerator.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$(dirname "$0")/.."
record=tests/library/interface_1.txt

# assertions: the record as C. (A type may have several words, so it is what is left of a line.)
assertions() {
    cat <<'END'
#include <raytally/accel.h>
#include <raytally/raytally.h>
#define SAME_TYPE(thing, ...) __builtin_types_compatible_p(__typeof__(thing), __VA_ARGS__)
END
    awk 'function holds(what, name) { printf "_Static_assert(%s, \"interface 1: %s has changed\");\n", what, name }
         function rest(from) { for (text = $from; ++from <= NF;) text = text " " $from; return text }
         $1 == "value" { holds($2 " == " rest(3), $2) }
         $1 == "enum" { for (i = 2; i <= NF; i++) holds($i " == " i - 2, $i) }
         $1 == "count" { holds($2 " >= " $3, $2) }
         $1 ~ /^(fixed|grows)$/ { holds("sizeof(" $2 ")" ($1 == "fixed" ? " == " : " >= ") $3, struct = $2) }
         $1 ~ /^[0-9]+$/ { holds("offsetof(" struct ", " $2 ") == " $1 " && SAME_TYPE(((" struct " *)0)->" $2 ", " rest(3) ")", struct "." $2) }
         $1 == "function" { holds("SAME_TYPE(" $2 ", " rest(3) ")", $2) }
         $1 == "callback" { holds("SAME_TYPE((" $2 " *)0, " rest(3) ")", $2) }' "$record"
}
assertions >"$work/record.c"

# kept COMPILER HEADERS: they compile with the record
kept() {
    "$1" -std=c17 -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I "$2" "$work/record.c" 2>"$work/log"
}
for compiler in gcc clang; do
    command -v "$compiler" >/dev/null || continue
    kept "$compiler" include || complain "the headers do not keep interface 1: $(grep error: "$work/log")"
    # And a member that has moved is noticed.
    rm -rf "$work/include" && cp -r include "$work/include"
    sed -i 's/^    float tmin;/    float more, tmin;/' "$work/include/raytally/types.h"
    ! kept "$compiler" "$work/include" || complain "$compiler does not notice that raytally_ray.tmin has moved"
done

names() { grep -oE '\b(raytally|RAYTALLY)_\w+' | sort -u; }
missing=$(cat include/raytally/{accel,raytally}.h | "${CC:-cc}" -E -P -I include - | names | comm -23 - <(names <"$record"))
[ -z "$missing" ] || complain "$record does not have $missing"
conclude
