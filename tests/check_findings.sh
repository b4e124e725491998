#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_findings.sh: the findings of shipped experiments are bound to data, and their verdicts on papers to claims: reading one
# warns of nothing, each says what it does not show, and all expressions hold over results/reference. Uses $RT_PROGRAM.
set -uo pipefail
cd "$(dirname "$0")/.."
. tests/testing.sh
mkdir "$work/results"
for directory in results/reference/*/; do
    cp -r "$directory" "$work/results"
done

for yaml in experiments/*.yaml experiments/{lecture,papers}/*.yaml; do
    name=$(sed -n 's/^name: //p' "$yaml") problem=
    said=$("$program" run "$yaml" --dry-run --out "$work/dry/$name" 2>&1 >/dev/null | grep -E '(finding|paper).*: ')
    grep -q '^not_shown:' "$yaml" || problem="$yaml: not_shown is missing"
    [ -z "$said" ] || problem=$said
    if [ -z "$problem" ] && [ -d "$work/results/$name" ]; then
        # Predictions may fail; what stands below the finding does not hold in it, or in a verdict.
        "$program" report "$work/results/$name" >"$work/printed" 2>&1 && grep -q '^Finding:' "$work/printed" ||
            problem="$name has no report of a finding: $(cat "$work/printed")"
        said=$(sed -n '/^Finding:/,$p' "$work/printed" | grep -E '^  (does not hold|undecided|not supported) ') &&
            problem="$name: $said"
    fi
    [ -z "$problem" ] || complain "$problem"
done
conclude
