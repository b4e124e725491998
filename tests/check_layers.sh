#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_layers.sh [TREE]: no file includes a header of a directory above its own (linking only sees symbols). Only
# the registry and an accelerator's own file or folder know that accelerator: they alone name its operations, include from its
# folder or, outside accel/, open it by its name. Tests may include and open. Prints each violation; exit code 1 if there is one.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"
# A directory may include itself and those before it.
rooms="base text shape scene scenes accel render picture rays measure exact verify library experiment results claims run compare report cli tests"

includes_upward() {
    # shellcheck disable=SC2016 # the dollars are awk's
    find src accel scenes tests -name '*.[ch]' | sort | xargs awk -v rooms="$rooms" '
        BEGIN { for (i = split(rooms, list, " "); i > 0; i--) level[list[i]] = i }
        function level_of(path,    part) {
            sub(/^(src\/)?(core\/)?/, "", path)
            split(path, part, "/")
            return level[part[1]]
        }
        /^[ \t]*#[ \t]*include[ \t]*".*\// {
            split($0, quoted, "\"")
            if (!level_of(quoted[2]) || level_of(quoted[2]) > level_of(FILENAME)) print FILENAME ":" FNR ":" $0
        }'
}

# An accelerator defines rt_NAME_ops in one file, accel/NAME.c or one in its own folder. "NAME", "NAME:KEY=VALUE" and
# "OVERLAY+NAME" open it. Some parameters and columns have the same names: those words
# count only if they are opened; add to them below if a new accelerator has the name of a parameter or column.
knows_accelerators() {
    local home name names= spec opens='rt_(accel_open|accel_find|spec_parse)\('
    while IFS=: read -r home name; do
        name=${name#*rt_} name=${name%%_ops*}
        case $home in accel/*/*) home=${home%/*}/ ;; *) home=$home: ;; esac
        grep -rnw "rt_${name}_ops" src accel scenes tests --include='*.[ch]' | grep -v -e '^accel/registry.c:' -e "^$home" || true
        names+="|$name"
    done < <(grep -rE 'rt_[a-z0-9_]*_ops = \{' accel --include='*.c')
    grep -rnE '#[ \t]*include[ \t]*"accel/[^"]*/' src scenes || true
    spec='"([a-z][^" ]*\+)?'"(${names#|})"'([:+][^" ]*)?"'
    grep -rnE "$spec" src --include='*.[ch]' | grep -vE -e ':( \*|.*/\*.*"[a-z])' |
        grep -vE -e '"(cache|clusters|extents|item|light)(:[^" ]*)?"' || true
    grep -rnE "$opens$spec" src --include='*.[ch]' || true
}

upward=$(includes_upward) known=$(knows_accelerators)
[ -z "$upward" ] || printf 'includes a header of a directory above its own (the order: %s):\n%s\n' "$rooms" "$upward"
[ -z "$known" ] || printf 'names an accelerator (if it is another word here, add it to knows_accelerators in %s):\n%s\n' "$0" "$known"
[ -z "$upward$known" ]
