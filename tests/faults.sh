#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail
usage="Usage: tests/faults.sh [--jobs N] [NAME...]

Does \`raytally verify\` find what it should? Each of tests/faults/NAME.patch (or of those that are named) puts one fault into
a copy of the tree; the program is built there and asked to verify the accelerators that the patch names. What it finds, or
what crashes or hangs it, is found. A fault that is missed must say why (tests/faults/README.md).

  --jobs N   so many copies at once (default 1); each is built on its share of the processors
  --help     this text

The copies are build/faults/1..N, and stay for the next time; so do the logs of the last run. A minute or less a fault, and
some minutes for the first build of each copy; with ccache what was built before is not built again.
Exit code: 1 if a fault is missed without an explanation, is found though it is explained, does not apply or does not build;
2 if the copy without a fault does not pass, or the usage is wrong."

here=$(cd "$(dirname "$0")/.." && pwd)
limit=200       # seconds that a verification may take, which takes some ten: beyond, it hangs
limit_clean=1800 # the same of all that are named, without a fault
jobs=1
names=()
while [ $# -gt 0 ]; do
    case $1 in
    --help | -h) echo "$usage" && exit ;;
    --jobs) jobs=${2:-} && shift ;;
    --jobs=*) jobs=${1#*=} ;;
    -*) echo "faults.sh: no option $1; see --help" >&2 && exit 2 ;;
    *) names+=("$(basename "$1" .patch)") ;;
    esac
    shift
done
[[ $jobs =~ ^[1-9][0-9]*$ ]] || { echo "faults.sh: --jobs takes a number from 1 on" >&2 && exit 2; }
all=("$here"/tests/faults/*.patch)
[ ${#names[@]} -gt 0 ] || for patch in "${all[@]}"; do names+=("$(basename "$patch" .patch)"); done
for name in "${names[@]}"; do
    [ -e "$here/tests/faults/$name.patch" ] || { echo "faults.sh: there is no tests/faults/$name.patch" >&2 && exit 2; }
done
for tool in cmake ninja patch timeout; do
    command -v "$tool" >/dev/null || { echo "faults.sh: there is no $tool" >&2 && exit 2; }
done

share=$((($(nproc) + jobs - 1) / jobs))
root=$here/build/faults
mkdir -p "$root"
rm -f "$root"/*.log "$root"/*/verdicts

# field KEY PATCH: the rest of its line of that name, above the diff
field() {
    sed -n "/^--- /q; s/^$1: //p" "$2"
}

# What was changed for a fault is new again, however old the original is: so what follows from it is built again.
copy_tree() { # TO
    (cd "$here" && find . \( -path ./build -o -name .git -o -path ./results -o -path ./scenes/fetched \) -prune -o -type f -print) |
        while read -r file; do
            cmp -s "$here/$file" "$1/$file" && continue
            mkdir -p "$(dirname "$1/$file")"
            cp "$here/$file" "$1/$file"
        done
}

# Without optimisation those kernels that this machine does not choose, for they take longest to compile; and the others with
# little of it: each program runs once.
configure() { # COPY
    local idle="portable avx2" isa launcher=()
    grep -qw avx512bw /proc/cpuinfo || idle="portable avx512"
    grep -qw avx2 /proc/cpuinfo || idle="avx2 avx512"
    if command -v ccache >/dev/null; then launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache); fi
    for isa in $idle; do
        printf '%s\n' "file(GLOB idle accel/*/*_$isa.c)" "set_property(SOURCE \${idle} APPEND PROPERTY COMPILE_OPTIONS -O0)"
    done >>"$1/CMakeLists.txt"
    cmake -S "$1" -B "$1/build" -G Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_C_FLAGS_RELEASE=-O1 -DNDEBUG" "${launcher[@]}"
}

build() { # COPY
    CCACHE_BASEDIR=$1 CCACHE_NOHASHDIR=1 ninja -C "$1/build" -j "$share" raytally
}

# Verifies the accelerators SPEC, SPEC..., up to the first wrong answer: verify's exit code, or 124 after LIMIT seconds.
verify() { # COPY SPECS LIMIT
    local specs codes
    mapfile -t specs <<<"${2//, /$'\n'}"
    (cd "$1" && rm -rf verify-failures && timeout "$3" build/raytally verify "${specs[@]/#/--accel=}") |
        awk '{ print } / WRONG: / { exit 1 }'
    codes=("${PIPESTATUS[@]}")
    [ "${codes[1]}" = 0 ] || return 1
    return "${codes[0]}"
}

# found, missed, "does not apply", ... to stdout; what was said to the log.
judge() { # COPY NAME LOG
    local patch=$here/tests/faults/$2.patch file outcome code=0
    patch -p1 -d "$1" --dry-run --fuzz=0 <"$patch" >"$3" 2>&1 || { echo "does not apply" && return; }
    patch -p1 -d "$1" --fuzz=0 --no-backup-if-mismatch <"$patch" >>"$3" 2>&1
    if build "$1" >>"$3" 2>&1; then
        verify "$1" "$(field accel "$patch")" "$limit" >>"$3" 2>&1 || code=$?
        case $code in
        0) outcome=missed ;;
        1) outcome=found ;;
        2) outcome="not verified" ;;
        124) outcome="found (hangs)" ;;
        *) outcome="found (crashes)" ;;
        esac
    else
        outcome="does not build"
    fi
    patch -R -p1 -d "$1" --fuzz=0 --no-backup-if-mismatch <"$patch" >>"$3" 2>&1
    sed -n 's|^+++ b/||p' "$patch" | while read -r file; do touch "$1/$file"; done
    echo "$outcome"
}

# Whether an outcome is what the patch says: `missed` with an explanation, or found without one.
as_said() { # NAME OUTCOME
    if [ -n "$(field missed "$here/tests/faults/$1.patch")" ]; then [ "$2" = missed ]; else [[ $2 = found* ]]; fi
}

# Every so many of the faults, from the one of its own number on.
work() { # NUMBER
    local copy=$root/$1 i name began outcome judged left
    for ((i = $1 - 1; i < ${#names[@]}; i += jobs)); do
        name=${names[i]} began=$SECONDS
        outcome=$(judge "$copy" "$name" "$root/$name.log")
        printf '%s\t%s\t%d\n' "$name" "$outcome" $((SECONDS - began)) >>"$copy/verdicts"
        judged=$(cat "$root"/*/verdicts | wc -l)
        left=$((SECONDS * (${#names[@]} - judged) / judged / 60))
        as_said "$name" "$outcome" || outcome="$outcome, not as it says"
        printf '[%d/%d] %-24s %s, %d s; %d min left\n' "$judged" ${#names[@]} "$name" "$outcome" $((SECONDS - began)) "$left" >&2
    done
}

# ---- copies without a fault ----

for ((k = 1; k <= jobs; k++)); do
    copy=$root/$k
    echo "copy $k of $jobs: building it without a fault" >&2
    mkdir -p "$copy"
    copy_tree "$copy"
    { configure "$copy" && build "$copy"; } >"$root/copy.log" 2>&1 || { tail -n 20 "$root/copy.log" >&2 && exit 2; }
done
asked=$(for name in "${names[@]}"; do field accel "$here/tests/faults/$name.patch"; done | sed 's/, /\n/g' | sort -u)
echo "verifying it" >&2
verify "$root/1" "$asked" "$limit_clean" >"$root/copy.log" 2>&1 || {
    tail -n 20 "$root/copy.log" >&2
    echo "faults.sh: without a fault it does not pass: $root/copy.log" >&2
    exit 2
}

# ---- and with one ----

SECONDS=0
for ((k = 1; k <= jobs; k++)); do work "$k" & done
wait

wrong=0 explained=0 found=0
printf '\n%-24s %-34s %-16s %s\n' fault accelerators outcome seconds
while IFS=$'\t' read -r name outcome seconds; do
    patch=$here/tests/faults/$name.patch
    why=$(field missed "$patch")
    printf '%-24s %-34s %-16s %7d' "$name" "$(field accel "$patch")" "$outcome" "$seconds"
    if [ -n "$why" ]; then explained=$((explained + 1)); elif [[ $outcome = found* ]]; then found=$((found + 1)); fi
    if as_said "$name" "$outcome"; then
        [ -z "$why" ] || printf '  (%s)' "$why"
    else
        wrong=$((wrong + 1))
        printf '  <- %s' "$([ -n "$why" ] && echo "its explanation says that it is missed" || echo "see $root/$name.log")"
    fi
    echo
done < <(sort "$root"/*/verdicts)
tried=$((${#names[@]} - explained))
[ "$tried" -eq 0 ] || printf '%d of %d faults found (%d %%), ' "$found" "$tried" $((100 * found / tried))
printf '%d explained, %d not as they say, in %d s\n' "$explained" "$wrong" "$SECONDS"
[ "$wrong" -eq 0 ]
