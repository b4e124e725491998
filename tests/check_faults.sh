#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_faults.sh [TREE]: the patches of tests/faults/ are there to be used: each applies to the tree and says what the fault
# is, its kind, and which accelerators are to be verified, by name; there are 60 at least, and one for each accelerator that
# is registered. Whether verify finds them is what tests/faults.sh tells, in an hour. Skipped (77) where there is no patch(1).
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"
command -v patch >/dev/null || { echo "skipped: faults on purpose apply; needs patch" && exit 77; }
failures=0
report() {
    echo "$*"
    failures=$((failures + 1))
}

count=0 named=
registered=$(sed -n 's/^const RtAccelOps rt_\([a-z]*\)_ops = {.*/\1/p' accel/*.c accel/*/*.c)
for patch in tests/faults/*.patch; do
    [ -e "$patch" ] || break
    count=$((count + 1))
    said=$(patch -p1 --dry-run --force --fuzz=0 <"$patch" 2>&1) || report "$patch does not apply: ${said//$'\n'/; }"
    header=$(sed '/^--- /,$d' "$patch")
    for key in fault kind accel; do
        [ "$(grep -c "^$key: ." <<<"$header")" = 1 ] || report "$patch does not say '$key: ...' once, above the diff"
    done
    read -ra layers < <(sed -n 's/, / /g; s/+/ /g; s/^accel: //p' <<<"$header")
    for layer in "${layers[@]}"; do
        name=${layer%%:*}
        grep -qx "$name" <<<"$registered" || report "$patch is for $name, which is no accelerator"
        named+=" $name"
    done
done
[ "$count" -ge 60 ] || report "there are $count faults: at least 60 are wanted"
for name in $registered; do
    [[ "$named " = *" $name "* ]] || report "there is no fault for $name"
done
[ "$failures" -eq 0 ]
