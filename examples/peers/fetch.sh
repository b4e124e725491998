#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# fetch.sh FOLDER [NAME...]: gets the libraries that the plugins of this folder measure, each at the commit they were tested with,
# into FOLDER/NAME; without a NAME, all. A library that is there at that commit stays as it is. Needs git and access to github.com.
# Exit code 2 if one could not be had.
set -euo pipefail

# name, repository, commit
libraries="
tinybvh jbikker/tinybvh 4735685f64d8b2bb0ad2c6c4643f291bf58774ad
madmann91 madmann91/bvh ac41ab88a32d0c247009d8ed456fd2795c1ee023
nanort lighttransport/nanort 31cc87c32c2b454d32c99925401a40c425954e66
fastbvh brandonpelfrey/Fast-BVH f2750b2d3543248b5b29dd97a630d35be5366678
visionaray szellmann/visionaray 172ccfc4c9eaf51d24e45ae56bf590df1960fe5b
"

say() { printf '%s\n' "$*" >&2; }

[ $# -ge 1 ] || { say "usage: fetch.sh FOLDER [NAME...]" && exit 2; }
folder=$1
shift

# fetch NAME REPOSITORY COMMIT: that commit alone, without history
fetch() {
    local place=$folder/$1
    [ "$(git -C "$place" rev-parse -q --verify HEAD 2>/dev/null)" != "$3" ] || { say "$place: already there" && return 0; }
    [ ! -e "$place" ] || { say "$place: is not $2 at $3; remove it first" && return 1; }
    git init -q "$place" && git -C "$place" fetch -q --depth 1 "https://github.com/$2" "$3" &&
        git -C "$place" checkout -q FETCH_HEAD && say "$place: $2 at $3" && return
    say "$place: could not get $2"
    rm -rf -- "$place"
    return 1
}

known=$(awk 'NF { print $1 }' <<<"$libraries")
for name in "$@"; do
    grep -qx -- "$name" <<<"$known" || { say "fetch.sh: there is no library '$name'; there are: ${known//$'\n'/, }" && exit 2; }
done
mkdir -p "$folder"
failed=0
while read -r name repository commit; do
    [ -n "$name" ] || continue
    [ $# = 0 ] || printf '%s\n' "$@" | grep -qx -- "$name" || continue
    fetch "$name" "$repository" "$commit" || failed=2
done <<<"$libraries"
exit $failed
