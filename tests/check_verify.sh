#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_verify.sh [RAYS]: every accelerator traces RAYS hard rays on each family of scenes, a tenth of them where a ray takes
# five times as long, more than five million in all, without a wrong answer; wrong ones are left in verify-failures/ to be replayed.
# Takes three minutes on two cores: once, with the release build, is enough. Uses $RT_PROGRAM.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$(dirname "$0")/.."
rays=${1:-156000} all=0 table=$work/table

# verify_families RAYS SCENE...: adds to the sum
verify_families() {
    local each=$1 scenes hard
    shift
    "$program" verify "$@" --rays "$each" --json >"$table" || {
        grep '"says"\|"replay"\|"problem": "' "$table"
        exit 1
    }
    # The accelerators trace the same rays, a tenth of which are camera rays.
    scenes=$(grep -c '"accel": "brute"' "$table")
    hard=$((scenes * each / 10 * 9))
    echo "$hard hard rays on $scenes scenes, each answered by $(($(grep -c '"accel"' "$table") / scenes)) accelerators"
    [ "$scenes" = $# ]
    all=$((all + hard))
}

families=$(verified_scenes families)
slow='kind=instanced|kind=concentric'
# shellcheck disable=SC2046 # one word each
verify_families "$rays" $(grep -vE "$slow" <<<"$families")
# shellcheck disable=SC2046
verify_families $((rays / 10)) $(grep -E "$slow" <<<"$families")
[ "$all" -ge 5000000 ]
