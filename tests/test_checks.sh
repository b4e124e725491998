#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The checks of the tree detect violations: each runs on a small tree that breaks its rule. setup.sh builds
# a tree that was copied with its build folder, and installs packages that do not conflict; skipped.awk lists skipped tests.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
tree=$(mktemp -d) && trap 'rm -rf "$tree"' EXIT
failures=0

fresh_tree() {
    rm -rf "${tree:?}"/*
    mkdir -p "$tree"/{src/core/base,src/core/scene,src/render,accel,scenes,tests/accel}
    echo '#include "accel/accel.h"' >"$tree/src/render/frame.c"
    echo '#include "core/scene/scene.h"' >"$tree/scenes/balls.c"
    echo '#include "core/base/file.h"' >"$tree/src/core/scene/load.c"
    echo 'const RtAccelOps rt_grid_ops = {' >"$tree/accel/grid.c"
    echo 'X(rt_grid_ops)' >"$tree/accel/registry.c"
    echo '#include "testing.h"' >"$tree/tests/accel/test_grid.c"
    printf '%s\n' 'set(ALL src/render/frame.c' 'src/core/scene/load.c scenes/balls.c' 'accel/grid.c accel/registry.c)' \
        'raytally_tests(accel bvh' '  grid)' >"$tree/CMakeLists.txt"
    echo 'project(raytally VERSION 1.2.3 LANGUAGES C)' >>"$tree/CMakeLists.txt"
    echo 'version: 1.2.3' >"$tree/CITATION.cff"
    echo '## 1.2.3 (2001-09-26)' >"$tree/CHANGELOG.md"
    find "$tree" -type f -exec sed -i '1i# SPDX-License-Identifier: Apache-2.0' {} +
}

# expect passes|fails CHECK WHAT
expect() {
    local outcome=passes
    "$here/$2" "$tree" >/dev/null || outcome=fails
    [ "$outcome" = "$1" ] && return
    echo "$2 $outcome on $3"
    failures=$((failures + 1))
}

fresh_tree
expect passes check_layers.sh "a tree in order"
expect passes check_files.sh "a tree in order"

fresh_tree && echo '#include "render/frame.h"' >>"$tree/accel/grid.c"
expect fails check_layers.sh "an accelerator that includes the renderer"
fresh_tree && echo '  # include "core/scene/scene.h"' >"$tree/src/core/base/box.h"
expect fails check_layers.sh "a base header that includes the scene"
fresh_tree && echo '#include "accel/accel.h"' >>"$tree/scenes/balls.c"
expect fails check_layers.sh "a generator that includes accelerators"
fresh_tree && echo '#include "scenes/builtin.h"' >>"$tree/src/core/scene/load.c"
expect fails check_layers.sh "a reader that includes generators"
fresh_tree && echo 'return &rt_grid_ops;' >>"$tree/src/render/frame.c"
expect fails check_layers.sh "a renderer that names an accelerator"
fresh_tree && echo 'extern const RtAccelOps rt_grid_ops;' >>"$tree/tests/accel/test_grid.c"
expect fails check_layers.sh "a test that names an accelerator"

fresh_tree && mkdir "$tree/accel/octree" && echo 'const RtAccelOps rt_octree_ops = {' >"$tree/accel/octree/octree.c"
echo 'extern const RtAccelOps rt_octree_ops;' >"$tree/accel/octree/octree.h"
expect passes check_layers.sh "an accelerator in a folder of its own"
echo 'extern const RtAccelOps rt_octree_ops;' >>"$tree/accel/grid.c"
expect fails check_layers.sh "an accelerator that names another"

fresh_tree && printf '%s\n' '/* by log(1 + x) */' ' * or pow(x, y)' 'double root = sqrt(rt_log(x));' >>"$tree/accel/grid.c"
expect passes check_libm.sh "a root, a logarithm of our own, and others in comments"
for call in 'tan(x)' 'powf(x, 2)' 'log1p(x)' 'fma(x, y, z)'; do
    fresh_tree && echo "double y = 2 * $call;" >>"$tree/scenes/balls.c"
    expect fails check_libm.sh "$call"
done
fresh_tree && mkdir "$tree/accel/octree"
echo '#include "accel/octree/octree.h"' >>"$tree/tests/accel/test_grid.c"
expect passes check_layers.sh "a test that looks into an accelerator"
echo '#include "accel/octree/octree.h"' >>"$tree/src/render/frame.c"
expect fails check_layers.sh "a renderer that looks into an accelerator"
fresh_tree && echo 'if (strcmp(name, "grid") == 0) return;' >>"$tree/src/render/frame.c"
expect fails check_layers.sh "a renderer that compares with the name of an accelerator"
fresh_tree && echo 'rt_accel_open("overlay+grid:density=4", &scene);' >>"$tree/src/render/frame.c"
expect fails check_layers.sh "a renderer that opens an accelerator by name"
fresh_tree && echo 'rt_table("cache");' >>"$tree/src/render/frame.c"
echo 'const RtAccelOps rt_cache_ops = {' >>"$tree/accel/grid.c"
expect passes check_layers.sh "a word that an accelerator shares"
echo 'rt_accel_open("cache", &scene);' >>"$tree/src/render/frame.c"
expect fails check_layers.sh "a renderer that opens an accelerator called by a common word"

fresh_tree && sed -i 1d "$tree/accel/grid.c"
expect fails check_files.sh "a file without a licence"
fresh_tree && echo 'raytally_tests(scenes spd)' >>"$tree/CMakeLists.txt" && mkdir "$tree/tests/scene"
sed '' "$tree/tests/accel/test_grid.c" >"$tree/tests/scene/test_spd.c"
expect fails check_files.sh "a test that another directory has registered"
fresh_tree && touch "$tree/accel/octree.c"
expect fails check_files.sh "a file that is not built"
fresh_tree && touch "$tree/tests/accel/test_octree.c"
expect fails check_files.sh "a test that is not registered"
fresh_tree && touch "$tree/accel/grid_c.c" && sed -i 's|accel/grid\.c|accel/grid.c.orig|' "$tree/CMakeLists.txt"
expect fails check_files.sh "a name that only resembles one in the list"

fresh_tree && sed -i 's/1.2.3/1.2.2/' "$tree/CITATION.cff"
expect fails check_files.sh "a citation of another version"
fresh_tree && sed -i 's/## 1.2.3 /## 1.2.30 /' "$tree/CHANGELOG.md"
expect fails check_files.sh "a list of changes that begins with another version"
fresh_tree && echo '[that](nowhere.md)' >>"$tree/CHANGELOG.md"
expect fails check_files.sh "a link that leads nowhere"

# built TREE: the output of setup.sh while it builds a minimal tree
built() {
    bash -c 'source "$0/setup.sh" && build release' "$1" && [ -e "$1/build/release/made" ]
}
mkdir "$tree/original" && cp "$here/../setup.sh" "$here/../CMakePresets.json" "$tree/original"
printf '%s\n' 'cmake_minimum_required(VERSION 3.25)' 'project(small NONE)' \
    'add_custom_target(made ALL ${CMAKE_COMMAND} -E touch made)' >"$tree/original/CMakeLists.txt"
for round in first second; do
    said=$(built "$tree/original") && [[ $said != *afresh* ]] || {
        echo "setup.sh: the $round time a tree is built: $said"
        failures=$((failures + 1))
    }
done
cp -r "$tree/original" "$tree/copy" && rm "$tree/copy/build/release/made"
said=$(built "$tree/copy") && [[ $said == *"made for $tree/original: configuring it afresh for $tree/copy"* ]] || {
    echo "setup.sh: where the tree is a copy: $said"
    failures=$((failures + 1))
}
# add_packages if apt refuses any list with `bad` in it
cat >"$tree/original/adds.sh" <<'END'
source "${BASH_SOURCE[0]%/*}/setup.sh"
apt() {
    [[ " $* " != *' bad '* ]] || return 1
    [[ " $* " == *' --simulate '* ]] || printf '%s\n' "$@" | sed '/^-/d; 1d' >>added
}
add_packages a b c d bad f g h
END
said=$(bash "$tree/original/adds.sh" 2>&1)
[ "$(sort "$tree/original/added" | xargs)" = 'a b c d f g h' ] && [[ $said == *'bad does not go'* ]] || {
    echo "setup.sh: where a package conflicts: $said"
    failures=$((failures + 1))
}
# packages.txt has a name for each system, or none
echo 'ID_LIKE="rhel fedora"' >"$tree/fedora"
said=$(os_release=$tree/fedora bash -c 'source "$0" && packages build data' "$here/../setup.sh" | xargs)
[[ $said == 'gcc glibc-devel '*' glmark2' ]] || {
    echo "setup.sh: the packages of Fedora: $said"
    failures=$((failures + 1))
}
awk '/^[a-z]/ && NF != 4 { print "packages.txt: not four columns: " $0; bad = 1 } END { exit bad }' "$here/../packages.txt" ||
    failures=$((failures + 1))
# skipped.awk, on ctest's reports of one build, and of another that ran more tests
cat >"$tree/one.xml" <<'END'
<testcase name="script" classname="script" time="0.02" status="notrun">
<skipped message="SKIP_RETURN_CODE=77"/>
<system-out>skipped: a &amp; b; needs &quot;c&quot;
</system-out></testcase>
<testcase name="group" classname="group" time="0.02" status="run">
<system-out>[ RUN      ] one_case
skipped: needs d
[  SKIPPED ] one_case
[ RUN      ] run_elsewhere
skipped: needs e
[  SKIPPED ] run_elsewhere
[  SKIPPED ] 2 test(s), listed below:
[  SKIPPED ] one_case
[  SKIPPED ] run_elsewhere
</system-out></testcase>
END
printf '%s\n' '<testcase name="other" classname="other" time="0.02" status="run">' \
    '<system-out>[       OK ] run_elsewhere' '</system-out></testcase>' >"$tree/two.xml"
said=$(awk -f "$here/skipped.awk" "$tree/one.xml" "$tree/two.xml")
[ "$said" = $'skipped script: a & b; needs "c"\nskipped one_case: needs d' ] || {
    echo "skipped.awk: $said"
    failures=$((failures + 1))
}
# object FILE TEXT: a source with this text, compiled to the place of its library's objects
export RT_PROGRAM=$tree/build/raytally
object() {
    local output=$tree/build/CMakeFiles/raytally_${1%/*}.dir/src/$1.o
    mkdir -p "$tree/src/${1%/*}" "${output%/*}"
    echo "$2" >"$tree/src/$1" && "${CC:-cc}" -c "$tree/src/$1" -o "$output"
}
objects_in_order() {
    fresh_tree
    object base/file.c 'int rt_file(void) { return 1; }'
    object scene/load.c 'int rt_file(void); int rt_load(void) { return rt_file(); }'
    object scene/mesh.c 'int rt_load(void); int rt_mesh(void) { return rt_load(); }'
}
if command -v nm >/dev/null && command -v "${CC:-cc}" >/dev/null; then
    objects_in_order
    expect passes check_circles.sh "a tree in order"
    object scene/load.c 'int rt_mesh(void); int rt_load(void) { return rt_mesh(); }'
    expect fails check_circles.sh "two files that call each other"
    objects_in_order
    object scene/scene.c 'int rt_mesh(void); int rt_scene(void) { return rt_mesh(); }'
    object scene/load.c 'extern int rt_scene(void); int (*const rt_load)(void) = rt_scene;'
    expect fails check_circles.sh "three files in a circle, by a table"
    rm "$tree/src/scene/scene.c"
    expect passes check_circles.sh "an object of a file that is gone"
    objects_in_order
    echo '#include "core/scene/mesh.h"' >"$tree/src/core/scene/scene.h"
    echo '#include "scene.h"' >"$tree/src/core/scene/mesh.h"
    expect fails check_circles.sh "two headers that include each other"
    rm -r "$tree/build"
    mkdir -p "$tree/build/CMakeFiles"
    expect fails check_circles.sh "a build without objects"
fi

# guide passes|fails WHAT LINE...: a document with these lines
guide() {
    local outcome=passes wanted=$1 what=$2
    shift 2
    printf '%s\n' "$@" >"$tree/guide.md"
    RT_PROGRAM=$(type -P true) "$here/check_guide.sh" "$tree/guide.md" >/dev/null 2>&1 || outcome=fails
    [ "$outcome" = "$wanted" ] && return
    echo "check_guide.sh $outcome on $what"
    failures=$((failures + 1))
}
fence='```'
command=("${fence}sh" 'echo "1.5  tests"; echo last' "$fence")
exact="${fence}text exact"
guide passes "a command that works" "${command[@]}"
guide passes "what it prints" "${command[@]}" "$exact" '1.5  tests' last "$fence"
guide passes "what it prints at the end" "${command[@]}" "$exact" ... last "$fence"
guide passes "a file and a command that reads it" "${fence}yaml file=a.yaml" b "$fence" "${fence}sh" 'grep -x b a.yaml' "$fence"
guide passes "a document of the tree" "${fence}sh" 'test -s docs/scenes.md' "$fence"
guide passes "a scene of the tree" "${fence}sh" 'test -s scenes/lecture.yaml' "$fence"
guide passes "an exit code that is told" "${fence}sh exit=2" 'exit 2' "$fence"
guide passes "a program that is not there" "${command[@]}" "${fence}sh needs=no-such-program" no-such-program "$fence" "$exact" a "$fence"
guide passes "a slow command, which is left out" "${command[@]}" "${fence}sh slow" false "$fence"
guide passes "a link to a document, and one to the net" "${command[@]}" '[this](guide.md#a) [that](https://localhost/nowhere)'
guide fails "a link that leads nowhere" "${command[@]}" '[that](nowhere.md)'
guide fails "no command at all" 'only text'
guide fails "a command that fails" "${fence}sh" false "$fence"
guide fails "a command that fails before another" "${fence}sh" 'false' 'true' "$fence"
guide fails "a command that fails in a pipe" "${fence}sh" 'false | cat' "$fence"
guide fails "another exit code" "${fence}sh exit=2" 'exit 1' "$fence"
guide fails "another figure" "${command[@]}" "$exact" '1.6  tests' last "$fence"
guide fails "a line too few" "${command[@]}" "$exact" '1.5  tests' "$fence"
guide fails "output without a command" "${command[@]}" "${fence}text" a "$fence" "$exact" last "$fence"
guide fails "a word that means nothing" "${fence}sh slwo" true "$fence"
guide fails "a block that is indented" "${command[@]}" "  ${fence}sh" '  true' "  $fence"
guide fails "a block without an end" "${command[@]}" "${fence}sh" true

[ "$failures" = 0 ]
