#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_interface.sh: the public headers keep interface 1 (docs/interface.md). They compile with its record,
# tests/library/interface_1.c, with every available compiler, and the record names every function, type and enumerator. Changes to
# a copy of the headers show that it notices what breaks programs and plugins, and lets grow what may grow.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$(dirname "$0")/.."
record=tests/library/interface_1.c

# kept COMPILER HEADERS: they compile with the record
kept() {
    "$1" -std=c17 -Wall -Wextra -Wpedantic -Werror -fsyntax-only -I "$2" "$record" 2>"$work/log"
}
compilers=$(for name in gcc clang; do command -v "$name" || true; done)
for compiler in $compilers; do
    kept "$compiler" include || complain "the headers do not keep interface 1: $(grep error: "$work/log")"
done
[ "$failures" = 0 ] || conclude

names() { grep -oE '\b(raytally|RAYTALLY)_\w+' | sort -u; }
missing=$(cat include/raytally/{accel,raytally}.h | "${CC:-cc}" -E -P -I include - | names | comm -23 - <(names <"$record"))
[ -z "$missing" ] || complain "$record does not have $missing"

# changed HEADER SED-SCRIPT: makes $work/include, with this change
changed() {
    rm -rf "$work/include" && cp -r include "$work/include"
    sed -i -E "$2" "$work/include/raytally/$1"
    ! cmp -s "include/raytally/$1" "$work/include/raytally/$1" || complain "this changes nothing in $1: $2"
}
breaks() {
    changed "$@"
    for compiler in $compilers; do
        ! kept "$compiler" "$work/include" || complain "$compiler with the record does not notice in $1: $2"
    done
}
grows() {
    changed "$@"
    for compiler in $compilers; do
        kept "$compiler" "$work/include" || complain "$compiler with the record refuses in $1: $2: $(grep error: "$work/log")"
    done
}

breaks types.h 's/^    float tmin;/    float more, tmin;/'                     # a moved member
breaks types.h 's/^    uint32_t source;/    float source;/'                    # its type
breaks types.h 's/^    uint32_t source;/    uint32_t source, more;/'           # a struct without a size that grows
breaks types.h 's/^    RAYTALLY_SHADOW,/    RAYTALLY_MORE, RAYTALLY_SHADOW,/'  # another value
breaks types.h 's/RAYTALLY_MAX_RAY_KINDS = 16/RAYTALLY_MAX_RAY_KINDS = 17/'    # a longer array
breaks raytally.h 's/^RAYTALLY_API const char \*raytally_version/static int no/' # a function that is gone
breaks raytally.h 's/uint32_t depth,$/uint64_t depth,/'                        # a parameter of another type
breaks accel.h 's/^    uint32_t param_count;/    uint64_t more; &/'            # a member in the middle of a table
breaks accel.h 's/^#define RAYTALLY_ACCEL_ABI 1/#define RAYTALLY_ACCEL_ABI 2/' # a new number, and no new record
grows accel.h 's/^    uint64_t flags;/    uint64_t flags, more;/'              # a member at the end of a table
grows accel.h 's/^    uint32_t reserved;/    uint32_t more;/'                  # a member that was reserved
grows types.h 's/^    RAYTALLY_RAY_KINDS,/    RAYTALLY_MORE, RAYTALLY_RAY_KINDS,/' # a kind of rays
grows raytally.h 's/^RAYTALLY_API int raytally_abi/RAYTALLY_API int raytally_more(void);\n&/' # a function
conclude
