#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_arm.sh FOLDER: by hand, on Debian with a network; half an hour, without root. 64-bit ARM under emulation (qemu): counts,
# scenes, hits and images must be those of x86, byte for byte, and `verify` and unit tests must pass. FOLDER/root has Debian's
# libraries for arm64, of the release that runs here; FOLDER/neon this tree, cross-compiled; FOLDER/plain a program whose
# kernels do without NEON, and must need more instructions per ray: a table of them ends the output. A second run uses all
# again. $RT_PROGRAM is raytally on x86, of this tree. Exit code 77: skipped, with what is missing.
set -euo pipefail
[ $# = 1 ] || { echo "usage: tests/check_arm.sh FOLDER" >&2 && exit 2; }
cross=aarch64-linux-gnu
emulator=$(command -v qemu-aarch64-static || command -v qemu-aarch64 || true)
[ -n "$emulator" ] || { echo "skipped: needs qemu (qemu-user-static)" && exit 77; }
command -v $cross-gcc >/dev/null || { echo "skipped: needs a compiler for 64-bit ARM (gcc-$cross)" && exit 77; }
mkdir -p "$1" && folder=$(realpath "$1")
source "${BASH_SOURCE[0]%/*}/../setup.sh" # say, die, logged, packages; and the top of the tree
[ -x "${RT_PROGRAM:-build/release/raytally}" ] || die "needs build/release/raytally: ./run.sh builds it"
source tests/testing.sh
root=$folder/root
export QEMU_LD_PREFIX=$root

# `logged` turns -e off in these: commands are joined by &&.

# libraries: unpacked, not installed; apt chooses them among this machine's sources, in a state of its own
libraries() {
    local apt=$folder/apt options
    options=(-q -y -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State::Lists="$apt/lists"
        -o Dir::State::status="$apt/status" -o Dir::Cache="$apt")
    # shellcheck disable=SC2046 # the names are separate words
    mkdir -p "$apt"/{lists,archives}/partial "$root.part" && : >"$apt/status" && apt-get "${options[@]}" update &&
        apt-get "${options[@]}" install --download-only --no-install-recommends \
            $(packages build optional test | grep -- '-dev$') &&
        printf '%s\0' "$apt"/archives/*.deb | xargs -0 -I PACKAGE dpkg-deb -x PACKAGE "$root.part" && mv "$root.part" "$root"
}

# cross_build TARGET...: FOLDER/neon. The program runs at the addresses that it is linked for, which `instructions` needs.
cross_build() {
    export PKG_CONFIG_SYSROOT_DIR=$root PKG_CONFIG_LIBDIR=$root/usr/lib/$cross/pkgconfig:$root/usr/share/pkgconfig
    cmake --preset release -B "$folder/neon" -DRT_WERROR=ON -DRT_DEBUG_INFO=-g0 -DCMAKE_SYSTEM_NAME=Linux \
        -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_C_COMPILER=$cross-gcc -DCMAKE_SYSROOT="$root" -DCMAKE_EXE_LINKER_FLAGS=-no-pie \
        -DCMAKE_CROSSCOMPILING_EMULATOR="$emulator" -DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER \
        -DCMAKE_FIND_ROOT_PATH_MODE_{LIBRARY,INCLUDE,PACKAGE}=ONLY &&
        cmake --build "$folder/neon" -j "${JOBS:-$(nproc)}" --target "$@"
}

# without_neon: FOLDER/plain, by the same commands; its kernels come before those in the libraries
without_neon() {
    local commands
    commands=$(ninja -C "$folder/neon" -t commands raytally) && mkdir -p "$folder/kernels" && cd "$folder/neon" &&
        grep '_kernels\.c$' <<<"$commands" |
        sed -E "s#-MF \S+ -o \S+/(\w+\.c\.o)#-MF /dev/null -o '$folder/kernels/\1' -U__ARM_NEON#" | sh -e &&
        tail -n 1 <<<"$commands" | sed "s# -o raytally # '$folder'/kernels/*.o -o '$folder/plain' #" | sh -e
}

# answers PROGRAM INTO: hits, occluders and images of scenes with every shape
answers() {
    local scene kind
    mkdir "$2"
    for scene in balls:size=2 jacks:size=2 gears:size=1 tetra:size=4 csg-field; do
        for kind in primary shadow diffuse; do
            "$1" bench "$scene" --accel wide --rays $kind --size 40x40 --count-only --hits "$2/$scene-$kind.npy"
        done
        "$1" render "$scene" --accel item+light+wide --size 40x40 -o "$2/$scene.png"
    done >/dev/null 2>"$work/said" || { tail -n 5 "$work/said" >&2 && return 1; }
}

# instructions PROGRAM SCENE ACCEL: those that a frame of 16 x 16 pixels executes in kernels
instructions() {
    local step=-singlestep ranges
    [[ $("$emulator" --help) != *one-insn-per-tb* ]] || step=-one-insn-per-tb
    ranges=$($cross-readelf -sW "$1" | awk '$4 == "FILE" { kernels = $8 ~ /_kernels\.c$/ }
        kernels && $4 == "FUNC" { printf "%s0x%s+%s", comma, $2, $3; comma = "," }')
    "$emulator" $step -d exec,nochain -dfilter "$ranges" -D /dev/fd/3 "$1" render "$2" --accel "$3" --size 16x16 --depth 2 \
        --threads 1 -o "$work/image.png" 3>&1 >/dev/null | wc -l
}

# rays SCENE: those of such a frame
rays() {
    "$program" render "$1" --accel bvh --size 16x16 --depth 2 -o "$work/image.png" --stats "$work/stats.json" >/dev/null 2>&1
    sed -n 's/^  "rays": \([0-9]*\),$/\1/p' "$work/stats.json"
}

[ -e "$root" ] || { say "libraries for arm64: $root" && logged "$folder/libraries.log" libraries; }
tests=(base shape text exact)
say "building $folder/neon" && logged "$folder/neon.log" cross_build raytally "${tests[@]/#/test_}"
say "building $folder/plain" && (logged "$folder/plain.log" without_neon)
arm=$folder/raytally
printf '#!/bin/sh\nexec "%s" "%s/neon/raytally" "$@"\n' "$emulator" "$folder" >"$arm" && chmod +x "$arm"

say "counts and scenes of tests/golden"
RT_PROGRAM=$arm tests/check_counts.sh || complain "counts differ"
RT_PROGRAM=$arm tests/check_scenes.sh || complain "scenes differ"

say "hits and images"
for run in "x86 $program" "arm $arm"; do
    answers "${run#* }" "$work/${run%% *}" || complain "no answers: $run"
done
diff -rq "$work/x86" "$work/arm" || complain "hits or images differ"

say "verify --quick"
"$arm" verify --quick >"$work/verified" || complain "wrong answers: $(grep -v ' 0 *0$' "$work/verified")"
tail -n 2 "$work/verified"

say "unit tests"
RAYTALLY_CSG_RAYS=20000 ctest --test-dir "$folder/neon" -L "^($(IFS='|' && echo "${tests[*]}"))\$" -LE 'slow|long' \
    --output-on-failure --timeout 900 || complain "tests fail"

say "instructions of kernels per ray"
printf '| scene | accelerator | without NEON | with NEON | ratio |\n| --- | --- | ---: | ---: | ---: |\n'
for cell in "tetra:size=4 wide" "tetra:size=4 wide:packets=0" "balls:size=2 wide" "tetra:size=3 brute" "balls:size=1 brute" \
    "tetra:size=3 extents" "tetra:size=4 item+wide" "tetra:size=4 light+wide"; do
    read -r scene accel <<<"$cell"
    plain=$(instructions "$folder/plain" "$scene" "$accel") neon=$(instructions "$folder/neon/raytally" "$scene" "$accel")
    awk -v s="$scene" -v a="$accel" -v p="$plain" -v n="$neon" -v r="$(rays "$scene")" 'BEGIN {
        printf "| %s | %s | %.0f | %.0f | %.2f |\n", s, a, p / r, n / r, n / p; exit n >= p }' ||
        complain "$accel in $scene: no fewer instructions with NEON"
done
conclude
