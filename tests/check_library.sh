#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_library.sh: raytally as installed. Installs the build beside $RT_PROGRAM into a scratch prefix and checks: each header
# compiles as C99, C17 and C++17 without a warning with every available compiler, and so do all of them in one file; both
# libraries export raytally_* and nothing else; examples/embed, as installed, builds with the CMake package and with pkg-config, shared and
# static, runs, and counts what the program counts, also after the prefix was moved; doxygen finds a description of every declaration. Skipped
# (77) without cmake, pkg-config or nm; checks whose tools are missing are reported and skipped.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$(dirname "$0")/.."
build=$(dirname "$program")
for tool in cmake pkg-config nm; do
    command -v "$tool" >/dev/null || { echo "skipped: the installed library; needs $tool" && exit 77; }
done
prefix=$work/first

# quietly WHAT COMMAND...: if it fails, prints WHAT and its output
quietly() {
    local what=$1
    shift
    "$@" >"$work/log" 2>&1 && return
    complain "$what"
    cat "$work/log" >&2
    return 1
}

# ---- without tests ----
if command -v ninja >/dev/null; then
    quietly "cmake -DBUILD_TESTING=OFF fails" cmake --preset release -B "$work/untested" -DBUILD_TESTING=OFF || true
    grep -q '"file".*/src/library/' "$work/untested/compile_commands.json" || complain "without tests, the library is not built"
    grep '"file".*/tests/' "$work/untested/compile_commands.json" && complain "without tests, these are built"
fi

# ---- installed files ----
quietly "cmake --install fails" cmake --install "$build" --prefix "$prefix"
libraries=$(dirname "$(find "$prefix" -name libraytally.so)")
for file in bin/raytally include/raytally/raytally.h include/raytally/types.h lib/python3/dist-packages/raytally.py share/doc/raytally/examples/peers/fetch.sh; do
    [ -s "$prefix/$file" ] || complain "$file is not installed"
done

# compiles COMPILER LANGUAGE STANDARD: every installed header by itself, and all of them together
compiles() {
    local header all=()
    command -v "$1" >/dev/null || { echo "check_library: no $1: headers are not compiled by it" >&2 && return; }
    for header in "$prefix"/include/raytally/*.h; do
        quietly "$1 -std=$3 warns about ${header##*/}" "$1" -x "$2" -std="$3" -Wall -Wextra -Wpedantic -Wconversion \
            -Werror -fsyntax-only -I "$prefix/include" -include "raytally/${header##*/}" /dev/null || true
        all+=(-include "raytally/${header##*/}")
    done
    quietly "$1 -std=$3 does not take all headers together" "$1" -x "$2" -std="$3" -fsyntax-only -I "$prefix/include" \
        "${all[@]}" /dev/null || true
}
for compiler in gcc clang; do
    compiles "$compiler" c c99
    compiles "$compiler" c c17
done
for compiler in g++ clang++; do compiles "$compiler" c++ c++17; done

# exports FILE NM-OPTION...: visible names must be ours, and ours must be among them
exports() {
    local file=$1 names
    shift
    names=$(nm "$@" --defined-only "$file" | awk 'NF == 3 { print $3 }')
    grep -qx raytally_version <<<"$names" || complain "${file##*/} does not export raytally_version"
    names=$(grep -v '^raytally_' <<<"$names") && complain "${file##*/} exports $(head -n 5 <<<"$names" | tr '\n' ' ')"
    return 0
}
exports "$libraries/libraytally.so" -D
exports "$libraries/libraytally.a" -g
declared=$(grep -oE '\braytally_[a-z_]+\(' include/raytally/raytally.h | tr -d '(' | sort -u)
for name in $declared; do
    nm -D --defined-only "$libraries/libraytally.so" | grep -q " T $name$" || complain "$name is declared and not there"
done

# ---- a program that embeds it ----
counted=$("$RT_PROGRAM" bench balls:size=3 --size 128x128 --rays primary --accel bvh --accel grid:density=20 --count-only |
    awk '$1 == "bvh" || $1 == "grid:density=20" { if (++n <= 2) print $2, $4 }')

# runs PROGRAM: it prints the counts of raytally, and writes an image
runs() {
    local got
    rm -f "$work/embed.png"
    quietly "${1##*/} fails" env LD_LIBRARY_PATH="${2-}" "$1" balls:size=3 "$work/embed.png" || return 0
    got=$(awk '/object tests/ { printf "%.3g %.3g\n", $2, $5 }' "$work/log")
    [ "$got" = "$counted" ] || complain "${1##*/} counts $got, the program $counted"
    grep -q '2000 equal, 0 wrong$' "$work/log" || complain "${1##*/}: $(grep verified "$work/log")"
    [ "$(head -c 4 "$work/embed.png" | tail -c 3)" = PNG ] || complain "${1##*/} writes no PNG"
}

# linked HOW FLAGS...: builds examples/embed with them, to $work/embed-pc
linked() {
    quietly "the example does not build by $1" "${CC:-cc}" -std=c99 "$prefix/share/doc/raytally/examples/embed/embed.c" "${@:2}" -o "$work/embed-pc"
}

# embed: builds with the installation in $prefix
embed() {
    local libraries build=$work/embed-${prefix##*/} flags
    libraries=$(dirname "$(find "$prefix" -name libraytally.so)")
    quietly "find_package fails" cmake -S "$prefix/share/doc/raytally/examples/embed" -B "$build" -DCMAKE_PREFIX_PATH="$prefix" \
        -DCMAKE_C_FLAGS="-std=c99 -Wall -Wextra -Wpedantic -Werror" || return 0
    quietly "the example does not build by its CMake package" cmake --build "$build" || return 0
    runs "$build/embed"
    if [ -x "$build/embed_static" ]; then runs "$build/embed_static"; else complain "there is no raytally::static"; fi
    flags=$(PKG_CONFIG_PATH=$libraries/pkgconfig pkg-config --cflags --libs raytally) || { complain "no raytally.pc" && return; }
    # shellcheck disable=SC2086 # they are several
    if linked "pkg-config" $flags; then runs "$work/embed-pc" "$libraries"; fi
    flags=$(PKG_CONFIG_PATH=$libraries/pkgconfig pkg-config --static --cflags --libs raytally)
    # shellcheck disable=SC2086 # as above; and the program finds no libraytally.so
    if linked "pkg-config --static" ${flags/-lraytally/-l:libraytally.a}; then runs "$work/embed-pc"; fi
}
embed
mv "$prefix" "$work/second" && prefix=$work/second
embed

# ---- a program with a locale that writes 4.5 as 4,5 ----
cat >"$work/comma.c" <<'END'
#include <locale.h>
#include <raytally/raytally.h>
#include <stdio.h>
int main(void) {
    char spec[RAYTALLY_SPEC_CHARS];
    raytally_scene *scene;
    raytally_camera camera = {{0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 199.5f};
    raytally_error error = {RAYTALLY_OK, ""};
    if (!setlocale(LC_ALL, "") || *localeconv()->decimal_point != ',') return 77;
    if (raytally_spec_format("grid:density=4.5", spec, &error) != RAYTALLY_OK) puts(error.message);
    puts(spec);
    if (raytally_scene_open("balls:size=1", &scene, &error) != RAYTALLY_OK) puts(error.message);
    if (raytally_scene_set_camera(scene, &camera, &error) != RAYTALLY_OK) puts(error.message);
    return printf("%.1f\n", 4.5) == 4 ? 0 : 2;
}
END
if localedef -i de_DE -f UTF-8 "$work/de_DE.UTF-8" 2>/dev/null; then
    libraries=$(dirname "$(find "$prefix" -name libraytally.so)")
    flags=$(PKG_CONFIG_PATH=$libraries/pkgconfig pkg-config --cflags --libs raytally)
    # shellcheck disable=SC2086 # they are several
    quietly "a program does not build" "${CC:-cc}" -std=c99 "$work/comma.c" $flags -o "$work/comma" &&
        quietly "a program with another locale fails" env LD_LIBRARY_PATH="$libraries" LOCPATH="$work" LC_ALL=de_DE.UTF-8 "$work/comma" &&
        { grep -q ',density=4\.5,.*' "$work/log" && grep -q '199\.5' "$work/log" && grep -qx '4,5' "$work/log" || complain "in another locale: $(cat "$work/log")"; }
else
    echo "check_library: localedef makes no de_DE: a locale with a decimal comma is not tried" >&2
fi

# ---- its documentation ----
if command -v doxygen >/dev/null; then
    { cat docs/Doxyfile && echo "OUTPUT_DIRECTORY=$work"; } >"$work/Doxyfile"
    quietly "doxygen finds fault" doxygen "$work/Doxyfile" || true
else
    echo "check_library: doxygen is not installed: what it says of the headers is not checked" >&2
fi
conclude
