#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_valgrind.sh [DIRECTORY GROUP...]: by hand; it takes three minutes of a processor. valgrind's memcheck finds no error in the
# quicker groups of tests, or in those named, such as `scene mesh nff`. It sees what the sanitizers cannot: values that are not
# initialised; leaks are theirs. Uses the tests beside $RT_PROGRAM, of a release build with all kernels: valgrind does not know
# AVX-512, so there they choose those for AVX2. A test that fails does not matter here: valgrind is slow, and computes long
# double as double. Prints the seconds of each group, and the output of one with an error. Skipped (77) without valgrind.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(dirname "${RT_PROGRAM:-build/release/raytally}")
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
command -v valgrind >/dev/null || { echo "skipped: memcheck finds no error; needs valgrind" && exit 77; }

groups() {
    cat <<'END'
base base parallel ray transform
text csv npy table
shape bounds csg csg_trees hits shape solid_cases solid_faces triangle
scene csg_scene formula mesh mesh_damage nff yaml
scenes places
accel counters descriptions extents grid overlap overlays trees wide_layout
END
}
[ $# = 0 ] || groups() { echo "$@"; }

failed=0
while read -r directory names; do
    for name in $names; do
        start=$SECONDS result="no error" code=0
        valgrind -q --error-exitcode=99 --child-silent-after-fork=yes "$build/test_$directory" "$name" >"$work/output" 2>&1 </dev/null ||
            code=$?
        case $code in
        0 | 1) ;;
        77) result=skipped ;;
        *) result=errors failed=1 ;;
        esac
        printf '%-8s %-16s %5d s  %s\n' "$directory" "$name" $((SECONDS - start)) "$result"
        [ "$result" != errors ] || cat "$work/output"
    done
done < <(groups "$@")
exit $failed
