#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_completion.sh: src/cli/completion.bash completes commands, options, accelerators and scenes; its function is called as bash calls
# it. Uses $RT_PROGRAM.
set -uo pipefail
program=$(realpath "${RT_PROGRAM:-build/release/raytally}")
# shellcheck disable=SC1091
source "$(dirname "$0")/../src/cli/completion.bash"
failures=0

# offers LINE WORD...: these words, among others, replace the last word of the line
offers() {
    local word all
    # shellcheck disable=SC2001 # = is a word of its own
    read -ra COMP_WORDS <<<"$(sed 's/=/ = /g' <<<"$1")"
    case $1 in *' ') COMP_WORDS+=('') ;; esac
    COMP_WORDS[0]=$program COMP_CWORD=$((${#COMP_WORDS[@]} - 1)) COMPREPLY=()
    _raytally
    printf -v all '\n%s' "${COMPREPLY[@]}"
    for word in "${@:2}"; do
        [[ $all$'\n' == *$'\n'"$word"$'\n'* ]] && continue
        echo "'$1' is not completed by '$word' but by '${COMPREPLY[*]}'"
        failures=$((failures + 1))
    done
}

# offers_only LINE WORD...: exactly these words
offers_only() {
    offers "$@"
    [ ${#COMPREPLY[@]} = $(($# - 1)) ] && return
    echo "'$1' is completed by '${COMPREPLY[*]}'"
    failures=$((failures + 1))
}

offers 'raytally ' accels bench render
offers_only 'raytally be' bench
offers_only 'raytally bench --count' --count-only
offers_only 'raytally convert --r' --recentre
offers_only 'raytally bench --worker' # hidden
offers 'raytally bench balls --accel ' brute bvh grid octree all
offers_only 'raytally bench balls -a gr' grid
offers_only 'raytally bench balls --accel=gr' grid
offers 'raytally bench balls --accel=' kd all
offers_only 'raytally accels oct' octree
offers_only 'raytally bench tet' tetra
offers_only 'raytally verify --rays ' # a number
offers_only 'raytally run no_such' # files, by default
offers_only 'raytally nonsense --'
[ $failures = 0 ]
