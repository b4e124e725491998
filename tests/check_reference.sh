#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_reference.sh: counting again reproduces the counts of results/havran-1999, its comparison with published
# figures, and the counts of every directory in results/reference, byte for byte. Without the bunny the
# latter are skipped (exit code 77). Uses $RT_PROGRAM. Takes four minutes of processor time, on all processors.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${RT_PROGRAM:-build/release/raytally}

if [ -e results/havran-1999/manifest.json ]; then
    "$program" reproduce results/havran-1999
fi
[ -e scenes/fetched/bunny.obj ] || {
    echo "skipped: counts of results/reference; needs the bunny (scenes/fetch.sh bunny)"
    exit 77
}
for directory in results/reference/*/; do
    "$program" reproduce "${directory%/}"
done
