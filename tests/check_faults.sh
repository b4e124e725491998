#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_faults.sh [TREE]: each line of tests/faults/faults.tsv applies: its text occurs exactly once in its file, and its
# accelerators exist. There are at least 60 faults, and at least one for each registered accelerator.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"
failures=0 names= layers=
registered=$(sed -n 's/^const RtAccelOps rt_\([a-z]*\)_ops = {.*/\1/p' accel/*.c accel/*/*.c)
report() {
    echo "$*"
    failures=$((failures + 1))
}
while IFS=$'\t' read -r name accels kind file text instead meaning _; do
    [ -n "$meaning" ] || report "$name: a fault has seven fields and, if verify misses it, an eighth that says why ($kind)"
    source=$(cat "$file") || source=
    if [[ $source != *"$text"* ]]; then
        report "$name: $file does not contain: $text"
    elif [[ ${source/"$text"/} = *"$text"* ]]; then
        report "$name: $file contains more than once: $text"
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
