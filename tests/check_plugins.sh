#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_plugins.sh: a faulty plugin damages only its own results. For each fault of tests/plugins/faulty.c, `verify` and `bench`
# report it and end with 1, and the results of another accelerator beside it are complete, JSON included. A library that cannot
# be loaded is rejected with exit code 2 and a sentence. A fresh `raytally new-accel` and the plugins of examples/ are built
# against an installed raytally, the first also against the build folder, verified and measured (those in C++ if there is a
# compiler for it). Uses $RT_PROGRAM, in its build folder, and python3.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
root=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
build=$(dirname "$program") plugins=$(dirname "$program")/plugins
for tool in cmake python3; do
    command -v $tool >/dev/null || { echo "skipped: plugins, faulty and right; needs $tool" && exit 77; }
done
cd "$work" || exit 2
unset RAYTALLY_PLUGINS
export RAYTALLY_PLUGIN_SECONDS=1

# refuses PATTERN FILE: nothing on stdout, exit code 2, and a message that says what to do
refuses() {
    ends 2 accels --plugin "$2"
    [ ! -s printed ] || complain "raytally accels --plugin $2: writes to stdout"
    says "$1"
}

# This takes ten seconds, in parallel with the rest.
(mkdir forever && cd forever && refuses 'loading it failed: it takes more than 10 seconds' "$plugins/unloadable-FOREVER.so"
    exit "$failures") &
forever=$!

# ---- faults ----

verify=(verify balls:size=1 --rays 2000 --threads 2 --json)
bench=(bench balls:size=1 --rays 'primary,shadow' --size 16x16 --depth 2 --rounds 1 --json)
ends 0 "${bench[@]}" --accel kd
mv printed alone.json

# fault NAME VERIFIED [MEASURED]: the reports of `verify` and `bench` (default: the same). Empty: no report, and exit code 0.
fault() {
    local name=faulty-$1 verified=$2 measured=${3-$2}
    ends $((${#verified} > 0)) "${verify[@]}" --plugin "$plugins/faulty.so" --accel "$name" --accel kd
    [ -z "$verified" ] || says "${name//+/.}.*$verified"
    mv printed "verify-$1.json"
    ends $((${#measured} > 0)) "${bench[@]}" --plugin "$plugins/faulty.so" --accel kd --accel "$name"
    [ -z "$measured" ] || says "${name//+/.}.*$measured"
    mv printed "bench-$1.json"
}

at_ray='at the ray org \([-0-9., e]+\) dir \([-0-9., e]+\)'
differs='answers to [0-9]+ of [0-9]+ [a-z]+ rays differ'
crash='crashed \(Segmentation fault'
fault not ''
fault print ''
fault crash-build "$crash\) while it was built over 11 objects"
fault crash-nearest "$crash\) .*$at_ray"
fault crash-timed "$crash\) .*$at_ray"
fault crash-rare "$crash\) .*$at_ray"
fault crash-together "$crash\) .*$at_ray"
fault crash-destroy "$crash\) while it was destroyed"
fault crash-describe "$crash\) while"
fault abort "crashed \(Aborted\) .*$at_ray"
fault exit 'ended its process \(exit code 0\)'
fault killed 'crashed \(Killed\)'
fault scribble 'overwrote memory that it shares with raytally while it was built'
fault kill ''
fault descriptor ''
fault trace ''
fault close ''
fault divide "crashed \(Floating point exception\) .*$at_ray"
fault recursion "$crash\) .*$at_ray"
fault free "crashed \(Aborted\) .*$at_ray"
fault object 'an object that does not exist, 1[0-9] \(the scene has 11 objects\)'
fault nan 't = nan'
fault farther 'expected .* got ' "$differs"
fault wrong 'expected .* got ' "$differs"
fault null 'expected .* got ' "$differs"
fault memory "wrote past the 48 bytes of its query's memory"
fault page 'past the memory of its query'
fault huge 'its query_bytes asks for 9223372036854775807 bytes for each query'
fault nonsense 'returned 42'
fault validate 'node 3 is its own parent' ''
fault boxes 'expected .* got ' "$differs"
fault moody 'counts [0-9]+ extent_tests on some [a-z]+ rays, and [0-9]+ when' \
    'counts [0-9]+ extent_tests on some [a-z]+ rays, and [0-9]+ when they are traced again'
fault lazy 'expected .* got ' "$differs.* in the timed kernel"
fault uncounted 'its object_tests for [a-z]+ rays add up to 0, and were [0-9]+'
fault twice 'its object_tests for [a-z]+ rays add up to [0-9]+, and were [0-9]+'
fault backwards 'counted [0-9]+ steps for [a-z]+ rays, more than possible'
fault occluder 'an occluder that the ray does not hit, 0 '
fault unnamed 'an object that does not exist, 4294967294 '
fault silent 'wrote no answer'
fault beyond 'wrote or read past its answers'
fault before 'wrote in front of its answers'
fault rays 'counts [0-9]+ object_hits on some [a-z]+ rays, and [0-9]+ when' 'wrote to the rays that it was given while it was timed'
fault box 'one of its boxes is NULL' ''
fault deep 'showed a box at depth 4294967295' ''
fault show "$crash\) while it showed its boxes" ''
fault debts 'description has the impossible number 18446744073709551615'
fault loop-nearest "no progress for 1 s .*$at_ray"
fault loop-timed "no progress for 1 s .*$at_ray"
RAYTALLY_PLUGIN_SECONDS=0.2 # a build may take ten times as long
fault loop-build 'no progress for 2 s .* while it was built'
RAYTALLY_PLUGIN_SECONDS=1
fault greedy 'memory is short'
fault older ''

# Overlays: the fault is named whichever layer has it, and a ray of its stream.
fault over+kd ''
fault over-crash+bvh "$crash\) .*; its stream begins with the ray org"
fault over+faulty-crash-rare "$crash\) .*, at the ray org"
fault over-crash+faulty-not "$crash\) .*; its stream begins with the ray org"
fault over+faulty-over-crash+kd "$crash\) .*; its stream begins with the ray org"
fault over-nan+bvh 'it passed on a ray that is not valid, of kind [0-6], org .* dir \(.*nan'
fault over-kind+bvh 'it passed on a ray that is not valid, of kind 77, org'
fault base 'it passes rays on, but its .flags. lack RAYTALLY_OVERLAY'

# Answers of its own hit functions may differ, but they must be answers.
fault own-object 'an object that does not exist, 1[0-9] \(the scene has 11 objects\)'
fault own-nan 't = nan, which is not on the ray'
fault own-endless 't = inf, which is not on the ray'
fault own-early 't = 0, which is not on the ray'
fault own-occluder 'an object that does not exist, 11 \(the scene has 11 objects\)'
fault own-moody 'counts [0-9]+ extent_tests on some [a-z]+ rays, and [0-9]+ when' \
    'counts [0-9]+ extent_tests on some [a-z]+ rays, and [0-9]+ when they are traced again'
fault own-unprepared "$crash\) .*; its stream begins with the ray org"
fault own-farther ''
fault own-uncounted ''
fault own-unnamed ''
fault own-wrong 'expected .* got ' ''
fault own-lazy 'timed kernel.* expected .* got no hit' ''
ends 0 "${bench[@]}" --plugin "$plugins/odd-INVASIVE.so" --accel kd
mv printed bench-invasive.json

python3 - <<'END' || failures=$((failures + 1))
import glob, json, sys

def load(name):
    try:
        return json.load(open(name))
    except ValueError as error:
        sys.exit(f"{name} is no JSON: {error}")

def of_kd(document):
    return [(row["kind"], row["counts"], "ns" in row) for row in document["rows"] if row["accel"] == "kd"]

alone, failed = of_kd(load("alone.json")), False
for name in sorted(glob.glob("bench-*.json")):
    if of_kd(load(name)) != alone:
        print(f"{name}: the measurements of kd differ from those without the plugin")
        failed = True
# An accelerator with its own hit functions is timed, and its rows say how many answers differ.
for name, differs in {"older": 0, "own-unnamed": 0, "own-uncounted": 0, "own-farther": 1, "own-wrong": 1, "own-lazy": 1}.items():
    rows = [row for row in load(f"bench-{name}.json")["rows"] if row["accel"] == f"faulty-{name}"]
    if len(rows) != 2 or any(row["ns"] <= 0 for row in rows) or (rows[0]["differ"] > 0) != differs:
        print(f"bench-{name}.json: not timed, or answers that differ are counted wrongly: {rows}")
        failed = True
right = ("verify-not.json", "verify-print.json", "verify-older.json", "verify-own-farther.json", "verify-own-uncounted.json",
         "verify-own-unnamed.json")
for name in sorted(glob.glob("verify-*.json")):
    rows = [row for row in load(name)["rows"] if row["accel"] == "kd" or name in right]
    if len(rows) != 1 + (name in right) or any(row["rays"] != 2000 or row["equal"] != 2000 or row["problem"] for row in rows):
        print(f"{name}: correct accelerators fail: {rows}")
        failed = True
sys.exit(failed or len(alone) != 2)
END

# ---- what affects no answer ----

# notices NAME [PATTERN]: bench and verify end with 0 and say so; no pattern: they say nothing
notices() {
    ends 0 verify balls:size=1 --rays 100 --threads 1 --plugin "$plugins/faulty.so" --accel kd --accel "faulty-$1"
    [ -z "${2-}" ] && [ -s said ] && complain "verify --accel faulty-$1 says $(cat said)"
    says "${2-}"
    ends 0 "${bench[@]}" --plugin "$plugins/faulty.so" --accel kd --accel "faulty-$1"
    [ -z "${2-}" ] && [ -s said ] && complain "bench --accel faulty-$1 says $(cat said)"
    says "${2-}"
}
RAYTALLY_PLUGIN_SECONDS=20 # memory takes time where the machine is busy
notices not
notices pool
notices refused '(refused|left out): faulty-refused: scenes of 11 objects are beneath it'
notices mumble '(refused|left out): faulty-mumble: [?]{40}'
notices leak 'faulty-leak: its process holds 3[0-9][0-9] MB of memory once it is built, and its .describe. says 0 MB'
notices leaking 'faulty-leaking: its process holds 3[0-9][0-9] MB more memory after tracing'
notices thread 'faulty-thread: it left a thread behind, still running after .destroy.'
notices daemon 'faulty-daemon: it left 1 process behind \(raytally\), which raytally ended'

RAYTALLY_PLUGIN_SECONDS=1

# ---- an experiment ----

cat >faulty.yaml <<'END'
name: faulty
question: Does an experiment outlive what it measures?
prediction: It does.
scenes:
  - {scene: "balls:size=1", size: 16x16, depth: 2}
accelerators:
  - {accel: kd}
  - {accel: faulty-crash-rare}
  - {accel: faulty-refused}
baseline: kd
rays: [primary, shadow]
rounds: 1
milliseconds: 1
END
ends 1 run faulty.yaml --plugin "$plugins/faulty.so"
says "faulty-crash-rare on .*$crash"
says 'faulty-refused on .*beneath it'
[ "$(grep -c ',kd,' results/faulty/counts.csv)" = 2 ] || complain "an experiment lacks rows of kd: $(cat results/faulty/counts.csv)"
[ -s results/faulty/report.html ] || complain 'an experiment with a faulty plugin has no report'
ends 1 run faulty.yaml --plugin "$plugins/faulty.so" --resume
ends 0 reproduce results/faulty --plugin "$plugins/faulty.so"
ends 0 report results/faulty --plugin "$plugins/faulty.so"

# So is a plugin that refuses the scene, and that alone is no failure.
sed '/crash-rare/d' faulty.yaml >refused.yaml
for resume in '' --resume; do
    ends 0 run refused.yaml --plugin "$plugins/faulty.so" --out refused $resume
    says 'Refused: faulty-refused on balls:size=1: .*beneath it'
done
ends 2 bench balls:size=1 --size 8x8 --plugin "$plugins/faulty.so" --accel faulty-refused
says 'every accelerator refuses the scene: faulty-refused: scenes of'
ends 0 verify balls:size=1 --rays 100 --plugin "$plugins/faulty.so" --accel faulty-refused --accel kd --json
python3 -c 'import json
rows = json.load(open("printed"))["rows"]
assert [bool(row["refused"]) for row in rows] == [True, False] and not any(row["problem"] for row in rows), rows' ||
    complain 'verify --json does not say which accelerator refuses the scene'

# A limit in an experiment holds for plugins, whether or not they keep to it.
sed '/refused/d; s/crash-rare/leak/; s/^rounds/limits: {megabytes: 100}\n&/' faulty.yaml >limited.yaml
ends 0 run limited.yaml --plugin "$plugins/faulty.so" --out limited
says 'refused: faulty-leak: its process used [1-3][0-9]{2}(\.[0-9])? MB of memory, more than 100 MB \(--memory\), while it was built over 11'
[ "$(grep -c ',kd,' limited/counts.csv)" = 2 ] || complain "an experiment with a limit lacks rows of kd"

# --memory is that limit, at any time: a plugin that exceeds it after its build is broken.
memory='its process used [1-3][0-9]{2}(\.[0-9])? MB of memory, more than 100 MB \(--memory\), while'
ends 0 "${bench[@]}" --plugin "$plugins/faulty.so" --accel kd --accel faulty-leak --memory 100M
says "refused: faulty-leak: $memory it was built"
ends 1 "${bench[@]}" --plugin "$plugins/faulty.so" --accel kd --accel faulty-leaking --memory 100M
says "faulty-leaking: $memory it answered a stream"
ends 0 verify balls:size=1 --rays 100 --plugin "$plugins/faulty.so" --accel faulty-leak --accel kd --memory 100M
says "refused: faulty-leak: $memory it was built"
ends 1 verify balls:size=1 --rays 100 --plugin "$plugins/faulty.so" --accel faulty-leaking --accel kd --memory 100M
says "faulty-leaking: $memory it was traced"
sed '/refused/d; s/crash-rare/leak/' faulty.yaml >unlimited.yaml
ends 0 run unlimited.yaml --plugin "$plugins/faulty.so" --out unlimited --memory 100M
says "refused: faulty-leak: $memory it was built"
ends 0 run unlimited.yaml --plugin "$plugins/faulty.so" --out unlimited --force --memory 1G
says 'faulty-leak: its process holds 3[0-9][0-9] MB'

# ---- the path of a ray ----

for spec in crash-nearest:"$crash" loop-nearest:'no progress' scribbled:'overwrote memory' backwards:'more than possible' \
    uncounted:'its object_tests for'; do
    ends 1 trace balls:size=1 --pixel 256,256 --plugin "$plugins/faulty.so" --accel "faulty-${spec%%:*}"
    says "${spec#*:}"
done
ends 2 trace balls:size=1 --pixel 256,256 --plugin "$plugins/faulty.so" --accel faulty-own-unnamed
says 'cannot follow a ray through a plugin that has hit functions of its own'
ends 0 trace balls:size=1 --pixel 256,256 --plugin "$plugins/bvh_copy.so" --accel bvh_copy --svg path.svg
tail -n +2 printed >path-copy
"$program" trace balls:size=1 --pixel 256,256 --accel bvh | tail -n +2 >path-bvh
diff <(sed '/^wrote/d' path-copy) path-bvh || complain 'the path of a ray through bvh_copy is not that through bvh'
[ -s path.svg ] || complain 'the path of a ray through bvh_copy is not drawn'

# ---- instructions by callgrind ----

# counted NAME: its count of instructions in counted.json, or why there is none
counted() {
    python3 -c 'import json, sys
for row in json.load(open("counted.json"))["instructions"]:
    if row["accel"] == sys.argv[1]: print(row.get("instructions") or "none:", row.get("why") or "")' "$1"
}

if command -v valgrind >/dev/null; then
    ends 0 bench balls:size=1 --rays primary --size 8x8 --depth 1 --count-only --callgrind --json \
        --plugin "$plugins/faulty.so" --accel faulty-not --accel faulty-illegal --accel faulty-print --accel faulty-own-wrong
    mv printed counted.json
    incapable='none: this build has kernels only for avx512' # then none has instructions
    [[ $(counted faulty-illegal) =~ ^('none: it has instructions that valgrind lacks, such as AVX-512'|$incapable) ]] ||
        complain "faulty-illegal: $(counted faulty-illegal)"
    for name in faulty-not faulty-print faulty-own-wrong; do
        [[ $(counted $name) =~ ^([1-9]|$incapable) ]] || complain "$name: instructions: $(counted $name)"
    done
fi

# ---- libraries that cannot be loaded ----

refuses 'nowhere.so: no such plugin' nowhere.so
echo text >text.so
refuses 'cannot be loaded: .*text.so' ./text.so
refuses 'no function .raytally_plugin.*new-accel' "$plugins/unloadable-SYMBOL.so"
refuses 'there is no accelerator in it' "$plugins/unloadable-EMPTY.so"
refuses 'version 2 .*compile it against the headers' "$plugins/unloadable-ABI.so"
refuses 'set .size. to sizeof' "$plugins/unloadable-SIZE.so"
refuses "'un loadable' cannot be the name of an accelerator" "$plugins/unloadable-NAME.so"
refuses "accelerator 'grid' already exists: choose another name" "$plugins/unloadable-TAKEN.so"
refuses "it has two accelerators 'unloadable': choose another name" "$plugins/unloadable-TWICE.so"
refuses "lacks its .*nearest" "$plugins/unloadable-FUNCTION.so"
refuses "'unloadable' lacks its .params" "$plugins/unloadable-PARAMETERS.so"
refuses "contradicts itself.*depth" "$plugins/unloadable-DEFAULT.so"
refuses "'unloadable' sets flags that this raytally does not know \(0x8000000000000000\)" "$plugins/unloadable-FLAGS.so"
refuses "parameter 'mode' of 'unloadable' has 71 choices; at most 64 are allowed" "$plugins/unloadable-CHOICES.so"
refuses 'loading it failed: it crashed \(Aborted\)' "$plugins/unloadable-CONSTRUCTOR.so"
refuses 'loading it failed: it crashed \(Aborted\)' "$plugins/unloadable-ENTRY.so"
for spec in faulty-not+bvh:'faulty-not is not an overlay, so it cannot stand before' \
    faulty-over:'faulty-over is an overlay and needs an accelerator below it: write faulty-over.bvh'; do
    ends 2 verify balls:size=1 --rays 10 --plugin "$plugins/faulty.so" --accel "${spec%%:*}"
    says "${spec#*:}"
done
wait $forever || failures=$((failures + 1))
mkdir folder && cp "$plugins/faulty.so" folder/
mkdir a:b 'c\d' && cp folder/faulty.so a:b/ && cp folder/faulty.so 'c\d/' && cp "$plugins/odd-LONGER.so" 'c\d/x:y.so'
for list in folder "$plugins/faulty.so:$plugins/new-accel.so" 'a\:b' 'c\d/faulty.so' 'c\\d/x\:y.so:a\:b'; do
    RAYTALLY_PLUGINS=$list "$program" accels >printed
    grep -q '^faulty-not' printed || complain "RAYTALLY_PLUGINS=$list: not loaded"
done
# Processes that raytally starts get the same plugins.
ends 0 compare balls:size=1 --plugin 'a:b/faulty.so' --accel faulty-not --with "$program" --rays primary --size 8x8 --limit 64 \
    --until 90% --patience 1

# ---- correct plugins, built against the build folder and against an installation ----

# works FOLDER: builds its plugin, if it has one, verifies and measures it
works() {
    local name=${1##*/} library accel
    grep -q 'raytally::headers\|MODULE' "$1/CMakeLists.txt" || return
    (cmake -S "$1" -B "built-$name" && cmake --build "built-$name") >log 2>&1 ||
        { complain "$1 cannot be built: $(tail -n 20 log)" && return; }
    for library in "built-$name"/*.so; do
        for accel in $(comm -13 <(names) <(names --plugin "$library")); do
            ! "$program" accels "$accel" --json --plugin "$library" | grep -q '"overlay": true' || accel=$accel+bvh
            ends 0 verify --quick --plugin "$library" --accel "$accel"
            ends 0 bench balls:size=2 --rays primary --size 16x16 --rounds 1 --plugin "$library" --accel bvh --accel "$accel"
            says "${accel//+/.}"
        done
    done
}

# names ARGUMENT...: the names of all accelerators, sorted
names() {
    "$program" accels --json "$@" | sed -nE 's/^      "name": "(.*)",?$/\1/p' | sort
}

"$program" new-accel early >/dev/null || complain 'raytally new-accel early fails'
PATH=$build:$PATH works early

cmake --install "$build" --prefix "$work/prefix" >log 2>&1 || complain "cmake --install: $(tail -n 5 log)"
program=$work/prefix/bin/raytally
export PATH=$work/prefix/bin:$PATH
(cd "$work" && raytally new-accel mine >/dev/null) || complain 'raytally new-accel mine fails'
works mine
(cmake --build built-mine --target check) >log 2>&1 || complain "the test of new-accel fails: $(tail -n 20 log)"
ends 2 render balls:size=1 --plugin built-mine/mine.so --accel mine --structure boxes.png
says 'no picture of mine.* a plugin shows its boxes by .each_box.'
for example in "$root"/examples/*/CMakeLists.txt; do
    case $example in
    *'*'* | */header-only/* | */peers/*) ;; # no match, or it needs a library that the user must get
    *-cpp/*) ! command -v c++ >/dev/null || works "${example%/*}" ;;
    *) works "${example%/*}" ;;
    esac
done

# What a plugin counts and does not show has no box, and whether the box is hit is unknown.
ends 0 trace balls:size=1 --pixel 256,256 --plugin built-bih/bih.so --accel bih --json
python3 -c 'import json
rows = json.load(open("printed"))["rows"]
extents = [row for row in rows if row["event"] == "extent test"]
assert extents and all(row["met"] is None and row["of"] is None and "box" not in row for row in extents), rows' ||
    complain 'trace --json says something of extent tests that bih does not show'

conclude
