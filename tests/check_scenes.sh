#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_scenes.sh [--update]: every built-in scene and family of scenes has its fingerprint in tests/golden/scenes.txt.
# Run for every build, this makes scenes bit-identical with every compiler and library. --update replaces the
# fingerprints: give the reason in tests/golden/CHANGES.md. Uses $RT_PROGRAM.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${RT_PROGRAM:-build/release/raytally}
golden=tests/golden/scenes.txt
now=$(mktemp) && trap 'rm -f "$now"' EXIT

while read -r scene _; do
    fingerprint=$("$program" info "$scene" | sed -n 's/^fingerprint: //p')
    echo "$scene $fingerprint"
done <"$golden" >"$now"
if [ "${1-}" = --update ]; then
    cp "$now" "$golden"
    exit
fi
diff "$golden" "$now"

# none is left out
builtins=$("$program" scenes | sed -n 's/^\([a-z-]*\): .*/\1/p')
families=$("$program" scenes family --json | sed -n 's/.*"range": "\(.*|.*\)".*/\1/p' | tr '|' ' ')
for name in $builtins ${families:?}; do
    grep -qE "^(family:kind=)?$name( |:|,)" "$golden" || { echo "$golden has no $name" && exit 1; }
done
