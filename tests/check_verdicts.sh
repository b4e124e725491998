#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_verdicts.sh [PLUGIN.so...]: Embree's native mode, and each library in a plugin, answer hard rays on hard scenes with no fault
# except those that tests/verify/faults.tsv lists with a cause. Far from the origin of coordinates a verdict on absolute coordinates
# is undecided, and neither `verify` nor its exit code calls that right. Uses $RT_PROGRAM. Some 20 seconds.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$(dirname "$0")/.."
list=tests/verify/faults.tsv

# faults SETTING SCENE... -- [OPTION...]: the faults of its wrong answers, as "lost beside"; "none" without any
faults() {
    local said setting=$1
    shift
    said=$("$program" verify --accel "$setting" --rays 5000 --out "$work/out" --force "$@" 2>"$work/err" || true)
    grep -q ' have a certain answer' <<<"$said" || complain "$setting has no verdict: $(tail -n 2 "$work/err")"
    sed -n 's/^.* have a certain answer.*; wrong: //p' <<<"$said" | tr -d '0-9,'
}

# listed SETTING [OPTION...]
listed() {
    local fault
    for fault in $(faults "$@"); do
        awk -F '\t' -v s="$1" -v f="$fault" '$1 == s && $2 == f { found = 1 } END { exit !found }' "$list" ||
            complain "$1: wrong answers with the fault '$fault', which $list does not list"
    done
}

if "$program" accels embree >/dev/null 2>&1; then
    for setting in $(sed -n 's/^\(embree[^\t]*\)\t.*/\1/p' "$list" | sort -u); do
        case $("$program" bench random:n=1 --size 4x4 --accel "$setting" --count-only 2>&1) in
        *"not in Embree 4"*) continue ;;
        esac
        listed "$setting"
    done
else
    echo "check_verdicts: built without Embree: its faults are not looked for" >&2
fi
for plugin in "$@"; do
    name=$(basename "$plugin" .so)
    for setting in "$name" $(sed -n "s/^\($name:[^\t]*\)\t.*/\1/p" "$list" | sort -u); do
        listed "$setting" triangles --plugin "$plugin"
    done
done

# ---- undecided is no success ----
printf 'v 1000000 0 0\nv 1000001 0 0\nv 1000000 1 0\nf 1 2 3\n' >"$work/far.obj"
if "$program" accels embree >/dev/null 2>&1; then
    status=0
    "$program" verify "$work/far.obj" --accel embree:mode=native --rays 2000 >"$work/out.txt" 2>"$work/err" || status=$?
    [ $status = 1 ] || complain "a verdict in absolute coordinates far from the origin: exit code $status"
    grep -q 'undecided: of 2000 rays' "$work/err" || complain "it is not called undecided: $(cat "$work/err")"
    grep -q '1 row undecided' "$work/out.txt" || complain "the sum does not name it: $(tail -n 1 "$work/out.txt")"
fi
conclude
