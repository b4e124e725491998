#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Sourced by run.sh and test.sh: changes to the top of the tree, installs missing packages, builds a preset.
# Works without root if nothing is missing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
exec </dev/null # nothing here reads stdin, which may be closed

say() { printf '== %s\n' "$*"; }
die() { printf '%s: %s\n' "${0##*/}" "$*" >&2 && exit 2; }

# packages SECTION...: the names that packages.txt lists in these sections for this system; Debian's on others
packages() {
    local system
    system="$(uname) $(sed -nE 's/^ID(_LIKE)?=//p' "${os_release:-/etc/os-release}" 2>/dev/null | xargs)"
    awk -v wanted="$*" -v ids="$system" '
        BEGIN {
            split(wanted, list, " ")
            for (i in list) want[list[i]] = 1
            column = ids ~ /fedora/ ? 2 : ids ~ /arch/ ? 3 : ids ~ /^Darwin/ ? 4 : 1
        }
        /^\[/ { section = $1; gsub(/[][]/, "", section) }
        /^[a-z0-9]/ && section in want && $column != "-" { print $column }' packages.txt
}

# missing SECTION...: the packages of these sections that are not installed
missing() {
    local name
    for name in $(packages "$@"); do
        dpkg-query -W -f '${db:Status-Status}\n' "$name" 2>/dev/null | grep -qx installed || echo "$name"
    done
}

# logged FILE COMMAND...: runs quietly; if the command fails, prints the end of its output
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

# add_packages NAME...: installs all that are compatible with this system. If apt refuses, each half is tried alone, which finds a
# conflicting package in few steps and installs the others. No package is removed.
add_packages() {
    local options=(-y --no-install-recommends --no-remove)
    if logged build/apt.log apt install --simulate "${options[@]}" "$@" 2>/dev/null; then
        logged build/apt.log apt install "${options[@]}" "$@"
    elif [ $# -gt 1 ]; then
        add_packages "${@:1:$#/2}" || true
        add_packages "${@:$#/2+1}"
    else
        say "$1 does not go with the installed packages: \`apt-get install $1\` says why"
    fi
}

# install_missing SECTION...: names packages that cannot be installed; fatal unless they are optional, or for the cluster or the pages
install_missing() {
    local section wanted=() needed=()
    for section; do
        case $section in
        optional | cluster | pages) wanted+=("$section") ;;
        *) needed+=("$section") ;;
        esac
    done
    command -v dpkg-query >/dev/null || {
        say "this is not Debian: install these packages or their equivalents: $(packages "$@" | xargs)"
        return
    }
    local names
    names=$(missing "$@" | xargs)
    [ -n "$names" ] || return 0
    if [ "$(id -u)" = 0 ] || { command -v sudo >/dev/null && sudo true; }; then
        say "installing $names"
        # shellcheck disable=SC2086 # the names are separate words
        if logged build/apt.log apt update; then
            add_packages $names || true
        fi
    fi
    names=$(missing "${wanted[@]}" | xargs)
    [ -z "$names" ] || say "continuing without $names"
    names=$(missing "${needed[@]}" | xargs)
    [ -z "$names" ] || die "packages are missing; as root: apt-get install --no-install-recommends $names"
}

# build PRESET [CMAKE OPTION...]: builds $targets, or everything. Configures from scratch if build/PRESET is a copy from
# another tree, which cmake refuses.
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
    # shellcheck disable=SC2086 # the targets are separate words
    logged "build/$preset.log" cmake --build --preset "$preset" -j "$(nproc)" --target ${targets:-all} ||
        die "the build failed: build/$preset.log"
}

fetch_bunny() {
    scenes/fetch.sh bunny 2>/dev/null || say "continuing without scenes/fetched/bunny.obj"
}
