#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_reference.sh [--whole]: counting again reproduces the counts of results/reference, byte for byte, of the cheapest scene in
# each directory (--whole: of all). The YAML files of experiments/ are those that were
# run; results of another system have a finding of their own. index.md lists the results. Skips (exit code 77) directories whose meshes were not fetched or whose instruction sets
# this build lacks. Uses $RT_PROGRAM.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${RT_PROGRAM:-build/release/raytally}
reference=results/reference
scenes=(--quick)
[ "${1-}" != --whole ] || scenes=()

# without_finding FILE: an experiment
without_finding() {
    awk '/^finding:/ { skipped = 1; next } /^[^ ]/ { skipped = 0 } !skipped' "$1"
}

for yaml in "$reference"/*/experiment.yaml; do
    name=$(sed -n 's/^name: //p' "$yaml") # NAME, or NAME-SYSTEM of another one
    directory=$(basename "$(dirname "$yaml")")
    [[ $directory = "$name" || $directory = "$name"-* ]] || { echo "$yaml is of experiment '$name'" && exit 1; }
    run=$(find experiments -name "$name.yaml" -not -path 'experiments/light-buffer/*')
    if [ "$directory" = "$name" ]; then cmp "$yaml" "$run"; else diff <(without_finding "$yaml") <(without_finding "$run"); fi
done
index=$(mktemp -d) && trap 'rm -rf "$index"' EXIT
for directory in "$reference"/*/; do ln -s "$PWD/$directory" "$index/$(basename "$directory")"; done
"$program" report --index "$index" >/dev/null
diff "$reference/index.md" "$index/index.md"

failed=0 skipped=0
for directory in "$reference"/*/; do
    directory=${directory%/}
    case ${directory##*/} in
    verify | verdicts) continue ;; # tests/check_verified.sh, tests/check_verdicts.sh
    esac
    code=0
    message=$("$program" reproduce "${scenes[@]}" "$directory" 2>&1) || code=$?
    if [ $code = 0 ]; then
        echo "$message"
    elif [ $code = 2 ] && grep -qE 'scenes/fetch.sh|this build has no kernels' <<<"$message"; then
        echo "skipped: $(tail -n 1 <<<"$message")"
        skipped=77
    else
        echo "$message"
        failed=1
    fi
done
[ $failed = 0 ] && exit $skipped
exit 1
