#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh and test.sh: moves to the top of the tree, installs missing packages, builds a preset.
# Works without root where nothing is missing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
exec </dev/null # nothing here asks questions; a closed stdin will do

say() { printf '== %s\n' "$*"; }
die() { printf '%s: %s\n' "${0##*/}" "$*" >&2 && exit 2; }

# packages SECTION...: the names that packages.txt lists there
packages() {
    awk -v wanted="$*" '
        BEGIN { split(wanted, list, " "); for (i in list) want[list[i]] = 1 }
        /^\[/ { section = $1; gsub(/[][]/, "", section) }
        /^[a-z0-9]/ && section in want { print $1 }' packages.txt
}

# missing SECTION...: of them, those not installed
missing() {
    local name
    for name in $(packages "$@"); do
        dpkg-query -W -f '${db:Status-Status}\n' "$name" 2>/dev/null | grep -qx installed || echo "$name"
    done
}

# logged FILE COMMAND...: quietly; where it fails, the end of its output
logged() {
    local log=$1 && shift
    mkdir -p "${log%/*}"
    "$@" >"$log" 2>&1 || { tail -n 40 "$log" >&2 && return 1; }
}

apt() {
    local root=()
    [ "$(id -u)" = 0 ] || root=(sudo)
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 "$@"
}

# add_packages NAME...: those that go together with what is here; where apt refuses, halves are tried by themselves, so that one
# package that conflicts keeps no other away and is found in few steps. Nothing is removed for them.
add_packages() {
    local options=(-y --no-install-recommends --no-remove)
    if logged build/apt.log apt install --simulate "${options[@]}" "$@" 2>/dev/null; then
        logged build/apt.log apt install "${options[@]}" "$@"
    elif [ $# -gt 1 ]; then
        add_packages "${@:1:$#/2}" || true
        add_packages "${@:$#/2+1}"
    else
        say "$1 does not go with what is installed here: \`apt-get install $1\` says why"
    fi
}

# install_missing SECTION...: what cannot be installed is named, and is fatal unless it is optional, or of the cluster or the pages
install_missing() {
    local section wanted=() needed=()
    for section; do
        case $section in
        optional | cluster | pages) wanted+=("$section") ;;
        *) needed+=("$section") ;;
        esac
    done
    command -v dpkg-query >/dev/null || {
        say "this is not Debian: have the counterparts of these ready: $(packages "$@" | xargs)"
        return
    }
    local names
    names=$(missing "$@" | xargs)
    [ -n "$names" ] || return 0
    if [ "$(id -u)" = 0 ] || { command -v sudo >/dev/null && sudo true; }; then
        say "installing $names"
        # shellcheck disable=SC2086 # the names are words of their own
        if logged build/apt.log apt update; then
            add_packages $names || true
        fi
    fi
    names=$(missing "${wanted[@]}" | xargs)
    [ -z "$names" ] || say "going on without $names"
    names=$(missing "${needed[@]}" | xargs)
    [ -z "$names" ] || die "packages are missing; as root: apt-get install --no-install-recommends $names"
}

# build PRESET [CMAKE OPTION...]: the targets of $targets, or all; from the beginning where
# build/PRESET came with a copy of another tree, which cmake refuses
build() {
    local preset=$1 made_for fresh=()
    say "building build/$preset"
    made_for=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "build/$preset/CMakeCache.txt" 2>/dev/null || true)
    if [ -n "$made_for" ] && ! [ "$made_for" -ef . ]; then
        say "build/$preset was made for $made_for: configuring it afresh for $PWD"
        fresh=(--fresh)
    fi
    logged "build/$preset.log" cmake "${fresh[@]}" --preset "$@" || die "cmake failed: build/$preset.log"
    grep -A 3 'CMake Warning' "build/$preset.log" | grep '^  ' || true
    # shellcheck disable=SC2086 # the targets are words of their own
    logged "build/$preset.log" cmake --build --preset "$preset" -j "$(nproc)" --target ${targets:-all} ||
        die "the build failed: build/$preset.log"
}

fetch_bunny() {
    scenes/fetch.sh bunny 2>/dev/null || say "going on without scenes/fetched/bunny.obj"
}
