#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_verdicts.sh [PLUGIN.so...]: Embree's native mode, and each library in a plugin, answer hard rays on hard scenes with no fault
# except those that tests/verify/faults.tsv lists with a cause. Far from the origin of coordinates a verdict on absolute coordinates
# is undecided, and neither `verify` nor its exit code calls that right. Uses $RT_PROGRAM. A minute on two cores.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$(dirname "$0")/.."
list=tests/verify/faults.tsv
slow=family:kind=instanced-stretched # fractions in the exact arithmetic get long

# listed "SETTING..." RAYS [SCENE|OPTION...]: all in one run, for which rays are judged certain once
listed() {
    local setting fault settings=$1 rays=$2
    shift 2
    # shellcheck disable=SC2086
    "$program" verify $(printf -- '--accel %s ' $settings) --rays "$rays" --json --out "$work/out" --force "$@" >"$work/rows" 2>"$work/err" || true
    # Lines "SETTING FAULT"; the fault "judged" where an answer was certain.
    awk -F '[":, ]+' '$2 == "accel" { setting = $0; sub(/^.*: "/, "", setting); sub(/",$/, "", setting) }
        $2 == "faults" { within = 1; next } /}/ { within = 0 }
        within && $3 > 0 { print setting, $2 }
        $2 == "certain" && $3 > 0 { print setting, "judged" }' "$work/rows" | sort -u >"$work/faults"
    for setting in $settings; do
        grep -qxF "$setting judged" "$work/faults" || complain "$setting has no verdict: $(tail -n 2 "$work/err")"
    done
    while read -r setting fault; do
        [ "$fault" = judged ] || awk -F '\t' -v s="$setting" -v f="$fault" '$1 == s && $2 == f { found = 1 } END { exit !found }' "$list" ||
            complain "$setting: wrong answers with the fault '$fault', which $list does not list"
    done <"$work/faults"
}

if "$program" accels embree >/dev/null 2>&1; then
    settings=
    for setting in $(sed -n 's/^\(embree[^\t]*\)\t.*/\1/p' "$list" | sort -u); do
        case $("$program" bench random:n=1 --size 4x4 --accel "$setting" --count-only 2>&1) in
        *"Embree 4 has no streams"*) continue ;;
        esac
        settings+=" $setting"
    done
    # shellcheck disable=SC2046 # one word each
    listed "$settings" 5000 $(verified_scenes | grep -vF "$slow")
    listed "$settings" 250 "$slow"
else
    echo "check_verdicts: built without Embree: its faults are not looked for" >&2
fi
for plugin in "$@"; do
    name=$(basename "$plugin" .so)
    listed "$name $(sed -n "s/^\($name:[^\t]*\)\t.*/\1/p" "$list" | sort -u)" 5000 triangles --plugin "$plugin"
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
