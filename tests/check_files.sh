#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_files.sh [TREE]: every .c file of the tree is built: CMakeLists.txt lists it, or for tests/DIRECTORY/test_NAME.c lists
# NAME in raytally_tests(DIRECTORY ...). Every source states its licence. Prints the files that fail; exit code 1 if
# there is one.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

status=0
list=$(tr '\n' ' ' <CMakeLists.txt)
while read -r path; do
    pattern="(^|[[:space:](])${path//./\\.}([[:space:])]|\$)"
    case $path in
    tests/*/test_*)
        name=${path##*/test_} directory=${path#tests/} directory=${directory%%/*}
        pattern="raytally_tests\\($directory[[:space:]]+([^)]*[[:space:]])?${name%.c}([[:space:])])"
        ;;
    esac
    grep -qE "$pattern" <<<"$list" || {
        echo "$path: not in CMakeLists.txt"
        status=1
    }
done < <(find src accel scenes tests -name '*.c' | sort)
while read -r path; do
    head -n 2 "$path" | grep -q 'SPDX-License-Identifier: Apache-2.0' || {
        echo "$path: no SPDX line"
        status=1
    }
done < <(find . -name build -prune -o \( -name '*.[ch]' -o -name '*.sh' -o -name '*.gp' -o -name '*.cmake' -o -name CMakeLists.txt \) -print |
    grep -v '^\./results/' | sort)
exit $status
