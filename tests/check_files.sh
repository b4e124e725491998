#!/usr/bin/env bash
# check_files.sh [TREE]: every .c file of the tree is built: CMakeLists.txt lists it, tests/ROOM/test_NAME.c as
# NAME in raytally_tests(ROOM ...). Prints those that are not; exit code 1 where there is one.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

status=0
list=$(tr '\n' ' ' <CMakeLists.txt)
while read -r path; do
    pattern="(^|[[:space:](])${path//./\\.}([[:space:])]|\$)"
    case $path in
    tests/*/test_*)
        name=${path##*/test_} room=${path#tests/} room=${room%%/*}
        pattern="raytally_tests\\($room([^)]*[[:space:]])?${name%.c}([[:space:])])"
        ;;
    esac
    grep -qE "$pattern" <<<"$list" || {
        echo "$path: not in CMakeLists.txt"
        status=1
    }
done < <(find src accel scenes tests -name '*.c' | sort)
exit $status
