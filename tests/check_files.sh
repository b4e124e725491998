#!/usr/bin/env bash
# check_files.sh [TREE]: every .c file of the tree is built: CMakeLists.txt lists it, tests/test_NAME.c as
# raytally_test(NAME). Prints those that are not; exit code 1 where there is one.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

status=0
while read -r path; do
    pattern="(^|[[:space:](])${path//./\\.}([[:space:])]|\$)"
    case $path in
    tests/test_*) name=${path#tests/test_} && pattern="raytally_test\\(${name%.c}([[:space:])])" ;;
    esac
    grep -qE "$pattern" CMakeLists.txt || {
        echo "$path: not in CMakeLists.txt"
        status=1
    }
done < <(find src accel experiments scenes tests -name '*.c' | sort)
exit $status
