#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_examples.sh: the plugins of examples/ and tests/plugins/bvh_copy.c, built against the public headers alone with every
# available compiler, and the one in Rust if there is rustc, without a warning: verify finds no wrong hit, whether products are fused
# or not; bvh_copy counts what bvh counts; verify detects a bih with one origin for both kinds of planes. examples/header-only and
# examples/peers explain how to get what they need; the first is built and verified if $BVH_DIR is a copy of madmann91/bvh, the second
# if $PEERS is the folder that its fetch.sh fills; the plugin in the README of peers is built with a library that tests all triangles.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$(dirname "$0")/.."

warnings=(-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror)
# builds COMPILER STANDARD SOURCE NAME [OPTION...]: to $work/NAME.so; false without this compiler
builds() {
    command -v "$1" >/dev/null || { echo "check_examples: no $1: $4 is not built by it" >&2 && return 1; }
    "$1" -std="$2" -O2 -fPIC -shared "${warnings[@]}" "${@:5}" -I include "$3" \
        -o "$work/$4.so" 2>"$work/log" && return
    complain "$1 -std=$2 does not build $3: $(cat "$work/log")"
    return 1
}

# verified NAME [SPEC]: the last line of verify
verified() {
    "$program" verify balls:size=2 tetra:size=3 random:n=0 random:n=1 random:n=40,shape=mixed,distribution=coincident \
        family:kind=axis-aligned --rays 5000 --plugin "$work/$1.so" --accel "${2-$1}" --spread --out "$work/out" --force 2>&1 |
        tail -n 1 || true
}

# right NAME [SPEC]: all rays of all scenes were traced, without a wrong answer
right() {
    local said form='^6 scenes, ([1-9][0-9]*) accelerators?, 5000 rays, ([0-9]+) comparisons: nothing wrong$'
    said=$(verified "$@")
    [[ $said =~ $form && ${BASH_REMATCH[2]} = $((6 * 5000 * BASH_REMATCH[1])) ]] || complain "$1: $said"
}

# refused COMPILER STANDARD OPTION: box.h does not compile without NaN and infinities
refused() {
    command -v "$1" >/dev/null || return 0
    "$1" -std="$2" "$3" -fsyntax-only -I include -include raytally/box.h -x c /dev/null 2>"$work/log" &&
        complain "$1 $3: box.h is compiled"
    grep -q 'needs NaN and infinities' "$work/log" || complain "$1 $3: box.h does not say why not: $(cat "$work/log")"
}

for compiler in gcc clang; do
    if builds "$compiler" c99 examples/bih/bih.c bih; then right bih; fi
    if builds "$compiler" c99 examples/shadow-cache/shadow_cache.c shadow-cache; then right shadow-cache shadow-cache+bvh; fi
    # Fused products, if the processor has them, would change the bits of hits.
    if builds "$compiler" gnu17 tests/plugins/bvh_copy.c bvh_copy -O3 -march=native -ffp-contract=fast; then right bvh_copy; fi
    if builds "$compiler" c17 tests/plugins/bvh_copy.c bvh_copy; then right bvh_copy; fi
    refused "$compiler" c99 -ffast-math
    refused "$compiler" c99 -ffinite-math-only
done
for compiler in g++ clang++; do
    if builds "$compiler" c++17 examples/bvh-cpp/hierarchy.cpp bvh_cpp; then right bvh_cpp; fi
    if [ -z "${BVH_DIR-}" ]; then
        echo "check_examples: no \$BVH_DIR: examples/header-only is not built" >&2
    elif builds "$compiler" c++20 examples/header-only/madmann.cpp madmann -isystem "$BVH_DIR/src"; then
        right madmann
    fi
done

if command -v rustc >/dev/null; then
    if rustc --edition 2021 --crate-type cdylib -O -C panic=abort -D warnings examples/slabs-rust/slabs.rs \
        -o "$work/slabs-rust.so" 2>"$work/log"; then
        right slabs-rust
    else
        complain "rustc does not build examples/slabs-rust: $(cat "$work/log")"
    fi
else
    echo "check_examples: no rustc: examples/slabs-rust is not built" >&2
fi

# ---- a copy of bvh behaves like bvh ----
if [ -e "$work/bvh_copy.so" ]; then # and the same structure: two rows of each table are equal
    counted=$("$program" bench balls:size=3 --size 64x64 --plugin "$work/bvh_copy.so" --accel bvh --accel bvh_copy --count-only |
        awk '$1 == "bvh" || $1 == "bvh_copy" { $1 = ""; print }' | sort | uniq -c)
    [ -n "$counted" ] && [ -z "$(awk '$1 % 2 != 0' <<<"$counted")" ] || complain "bvh_copy does not count what bvh counts: $counted"
fi

# ---- the mistake that the text of bih describes ----
sed 's/ray->org_near\[/ray->org[/; s/ray->org_far\[/ray->org[/' examples/bih/bih.c >"$work/bih.c"
if builds "${CC:-cc}" c99 "$work/bih.c" bih; then
    said=$(verified bih)
    grep -q '[1-9][0-9]* wrong' <<<"$said" || complain "bih without the thickness of rays is not found out: $said"
fi

# ---- libraries as they are ----
# judged NAME: no answer on scenes of triangles is wrong
judged() {
    local said
    said=$("$program" verify tetra:size=3 random:n=300,shape=triangle --rays 2000 --plugin "$work/$1.so" --accel "$1" \
        --out "$work/out" --force 2>&1 | tail -n 1 || true)
    [[ $said = '2 scenes, 1 accelerator, 2000 rays, 4000 comparisons: by verdicts, nothing wrong'* ]] || complain "$1: $said"
}

sed -n '/^```cpp$/,/^```$/p' examples/peers/README.md | sed '/^```/d' >"$work/mine.cpp"
if builds g++ c++20 "$work/mine.cpp" mine -I examples/peers -I tests/plugins; then judged mine; fi
if [ -z "${PEERS-}" ]; then
    echo "check_examples: no \$PEERS: plugins of libraries are not built" >&2
elif cmake -S examples/peers -B "$work/peers" -Draytally_DIR="$(dirname "$program")" -DPEERS="$(realpath "$PEERS")" \
    -DPEER_FLAGS="-O3 -march=native ${warnings[*]} -Wno-maybe-uninitialized" >"$work/log" 2>&1 &&
    cmake --build "$work/peers" >>"$work/log" 2>&1; then # what may be uninitialised is in a library
    grep 'left out' "$work/log" >&2 || true
    RT_PROGRAM=$program tests/check_verdicts.sh "$work"/peers/*.so || complain "the verdicts on libraries are not the expected ones"
else
    complain "examples/peers is not built: $(cat "$work/log")"
fi

# ---- without the libraries that the user must get ----
if command -v cmake >/dev/null; then
    cmake -S examples/header-only -B "$work/build" >"$work/log" 2>&1 && complain "header-only is made without BVH_DIR"
    grep -q 'git clone https://' "$work/log" || complain "header-only does not say how to get what it needs: $(cat "$work/log")"
    cmake -S examples/peers -B "$work/build-peers" >"$work/log" 2>&1 && complain "peers is made without PEERS"
    grep -q 'fetch.sh' "$work/log" || complain "peers does not say how to get what it needs: $(cat "$work/log")"
fi
conclude
