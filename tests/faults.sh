#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail
usage="Usage: tests/faults.sh [--jobs N] [NAME...]

Does \`raytally verify\` find what it should? Each line of tests/faults/faults.tsv, or each one that is named, puts one fault
into a copy of the tree. The program is built there and verifies the accelerators that the line names. A wrong answer, a
crash and an endless loop count as found. A fault that is missed must say why (tests/faults/README.md).

  --jobs N   use N copies at once (default 1); each is built on its share of the processors
  --help     this text

The copies, build/faults/1..N, are kept for the next run, and so are the logs. A fault takes a minute or less, the first
build of each copy some minutes; ccache is used if it is there.
Exit code: 1 if a fault is missed without an explanation, is found in spite of one, or does not build;
2 if a fault does not apply, the copy without a fault does not pass, or the usage is wrong."

here=$(cd "$(dirname "$0")/.." && pwd)
limit=200        # seconds for one verification, which takes some ten; beyond, it hangs
limit_clean=1800 # seconds for the verification without a fault
jobs=1
names=()
fail() {
    echo "faults.sh: $*" >&2
    exit 2
}
while [ $# -gt 0 ]; do
    case $1 in
    --help | -h) echo "$usage" && exit ;;
    --jobs) jobs=${2:-} && shift ;;
    --jobs=*) jobs=${1#*=} ;;
    -*) fail "no option $1; see --help" ;;
    *) names+=("$1") ;;
    esac
    shift
done
[[ $jobs =~ ^[1-9][0-9]*$ ]] || fail "--jobs takes a number from 1 on"
for tool in cmake ninja timeout; do command -v "$tool" >/dev/null || fail "there is no $tool"; done
"$here/tests/check_faults.sh" >&2 || fail "not every fault applies"

declare -A accels file text instead missed
all=()
while IFS=$'\t' read -r name specs _ path old new _ why; do
    all+=("$name") accels[$name]=$specs file[$name]=$path text[$name]=$old instead[$name]=$new missed[$name]=$why
done < <(grep -v '^#' "$here/tests/faults/faults.tsv")
[ ${#names[@]} -gt 0 ] || names=("${all[@]}")
for name in "${names[@]}"; do [ -n "${file[$name]:-}" ] || fail "tests/faults/faults.tsv has no $name"; done

share=$((($(nproc) + jobs - 1) / jobs))
root=$here/build/faults
source "$here/tests/faults/copy.sh"
mkdir -p "$root"
rm -f "$root"/*.log "$root"/*/verdicts

build() { # COPY
    CCACHE_BASEDIR=$1 CCACHE_NOHASHDIR=1 ninja -C "$1/build" -j "$share" raytally
}

# Verifies the accelerators up to the first wrong answer. Returns verify's exit code, or 124 after LIMIT seconds.
verify() { # COPY LIMIT SPEC...
    local codes specs=("${@:3}")
    (cd "$1" && rm -rf verify-failures && timeout "$2" build/raytally verify "${specs[@]/#/--accel=}") |
        awk '{ print } / WRONG: / { exit 1 }'
    codes=("${PIPESTATUS[@]}")
    [ "${codes[1]}" = 0 ] || return 1
    return "${codes[0]}"
}

# Prints found, missed, "does not build", ...; the log gets the rest.
judge() { # COPY NAME
    local source path=${file[$2]} code=0
    source=$(cat "$here/$path")
    printf '%s\n' "${source/"${text[$2]}"/"${instead[$2]}"}" >"$1/$path"
    if build "$1" >"$root/$2.log" 2>&1; then
        # shellcheck disable=SC2086 # specs contain no blanks
        verify "$1" "$limit" ${accels[$2]} >>"$root/$2.log" 2>&1 || code=$?
        case $code in
        0) echo missed ;;
        1) echo found ;;
        2) echo "not verified" ;;
        124) echo "found (hangs)" ;;
        *) echo "found (crashes)" ;;
        esac
    else
        echo "does not build"
    fi
    cp "$here/$path" "$1/$path"
}

# Is the outcome what the table says: missed with an explanation, or found without one?
as_said() { # NAME OUTCOME
    if [ -n "${missed[$1]}" ]; then [ "$2" = missed ]; else [[ $2 = found* ]]; fi
}

# Judges every jobs-th fault, from the NUMBERth on.
work() { # NUMBER
    local copy=$root/$1 i name began outcome judged left
    for ((i = $1 - 1; i < ${#names[@]}; i += jobs)); do
        name=${names[i]} began=$SECONDS
        outcome=$(judge "$copy" "$name")
        printf '%s\t%s\t%d\n' "$name" "$outcome" $((SECONDS - began)) >>"$copy/verdicts"
        judged=$(cat "$root"/*/verdicts | wc -l)
        left=$((SECONDS * (${#names[@]} - judged) / judged / 60))
        as_said "$name" "$outcome" || outcome="$outcome, not as it says"
        printf '[%d/%d] %-24s %s, %d s; %d min left\n' "$judged" ${#names[@]} "$name" "$outcome" $((SECONDS - began)) "$left" >&2
    done
}

for ((k = 1; k <= jobs; k++)); do
    echo "copy $k of $jobs: building it without a fault" >&2
    mkdir -p "$root/$k"
    copy_tree "$root/$k"
    { configure "$root/$k" && build "$root/$k"; } >"$root/copy.log" 2>&1 || { tail -n 20 "$root/copy.log" >&2 && exit 2; }
done
echo "verifying it" >&2
mapfile -t asked < <(for name in "${names[@]}"; do printf '%s\n' ${accels[$name]}; done | sort -u)
verify "$root/1" "$limit_clean" "${asked[@]}" >"$root/copy.log" 2>&1 || {
    tail -n 20 "$root/copy.log" >&2
    fail "without a fault it does not pass: $root/copy.log"
}

SECONDS=0
for ((k = 1; k <= jobs; k++)); do work "$k" & done
wait

wrong=0 explained=0 found=0
printf '\n%-24s %-34s %-16s %s\n' fault accelerators outcome seconds
while IFS=$'\t' read -r name outcome seconds; do
    why=${missed[$name]} note=
    if [ -n "$why" ]; then explained=$((explained + 1)) note="  ($why)"; elif [[ $outcome = found* ]]; then found=$((found + 1)); fi
    as_said "$name" "$outcome" || { wrong=$((wrong + 1)) && note="  <- not as it says: see $root/$name.log"; }
    printf '%-24s %-34s %-16s %7d%s\n' "$name" "${accels[$name]}" "$outcome" "$seconds" "$note"
done < <(sort "$root"/*/verdicts)
tried=$((${#names[@]} - explained))
[ "$tried" -eq 0 ] || printf '%d of %d faults found (%d %%), ' "$found" "$tried" $((100 * found / tried))
printf '%d explained, %d not as they say, in %d s\n' "$explained" "$wrong" "$SECONDS"
[ "$wrong" -eq 0 ]
