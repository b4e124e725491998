#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_reference.sh [--whole]: counting again reproduces the counts of two scenes of results/reference/havran-1999 and of every directory
# in results/reference, byte for byte. Without the bunny the latter are skipped (exit code 77). --whole: all five scenes of
# havran-1999, and the comparison with published figures; that takes five minutes of processor time more. Uses $RT_PROGRAM.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${RT_PROGRAM:-build/release/raytally}

if [ "${1-}" = --whole ]; then
    "$program" reproduce results/reference/havran-1999
else
    "$program" reproduce results/reference/havran-1999 --only tetra
    "$program" reproduce results/reference/havran-1999 --only lattice
fi
[ -e scenes/fetched/bunny.obj ] || {
    echo "skipped: counts of results/reference; needs the bunny (scenes/fetch.sh bunny)"
    exit 77
}
for directory in results/reference/*/; do
    "$program" reproduce "${directory%/}"
done
