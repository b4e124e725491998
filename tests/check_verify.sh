#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_verify.sh [RAYS]: every accelerator traces RAYS hard rays on each family of scenes, more than five million
# in all, without a wrong answer; wrong ones are left in verify-failures/ to be replayed. Takes some two
# minutes on two cores: once, with the release build, is enough. Uses $RT_PROGRAM.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${RT_PROGRAM:-build/release/raytally}
rays=${1:-135000}
table=$(mktemp) && trap 'rm -f "$table"' EXIT

"$program" verify families --rays "$rays" --json >"$table" || {
    grep '"says"\|"replay"\|"problem": "' "$table"
    exit 1
}
# The accelerators trace the same rays, a tenth of which are camera rays.
scenes=$(grep -c '"accel": "brute"' "$table")
hard=$((scenes * rays / 10 * 9))
echo "$hard hard rays on $scenes scenes, each answered by $(($(grep -c '"accel"' "$table") / scenes)) accelerators"
[ "$hard" -ge 5000000 ]
