#!/usr/bin/env bash
# check_reference.sh: counting again gives the counts of every directory in results/reference, byte for byte. Skipped
# (exit code 77) where the bunny was not fetched. Uses $RT_PROGRAM.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${RT_PROGRAM:-build/release/raytally}

[ -e scenes/fetched/bunny.obj ] || {
    echo "skipped: scenes/fetched/bunny.obj is missing; scenes/fetch.sh bunny brings it"
    exit 77
}
for directory in results/reference/*/; do
    "$program" reproduce "${directory%/}"
done
