#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The command line on bad input: exit code 2, nothing on stdout, a message that says where the mistake is, what it is and what
# would be right, and no file left behind. Uses $RT_PROGRAM.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
mkdir "$work/here" && cd "$work/here" || exit 1
# What a process still holds when it refuses its input is no leak, and the search takes half of AddressSanitizer's time here.
export ASAN_OPTIONS=detect_leaks=0
shopt -s globstar dotglob nullglob

# refuses PATTERN ARGUMENT...: the message must match the extended regular expression
refuses() {
    local pattern=$1 code=0 before after message
    shift
    before=(**)
    timeout 60 "$program" "$@" >../stdout 2>../stderr </dev/null || code=$?
    message=$(<../stderr) message=${message//$'\n'/ }
    [ -s ../stdout ] && complain "raytally $*: writes to stdout"
    after=(**)
    [ "$code" = 2 ] || complain "raytally $*: exit code $code, not 2: $message"
    [[ $message =~ $pattern ]] || complain "raytally $*: the message does not say '$pattern': $message"
    [ "${before[*]}" = "${after[*]}" ] || complain "raytally $*: leaves files: before ${before[*]}, after ${after[*]}"
}

# nff NAME LINE...: a scene of a camera, a material and these lines, the first being line 9
nff() {
    local name=$1
    shift
    printf '%s\n' v 'from 0 0 9' 'at 0 0 0' 'up 0 1 0' 'angle 45' 'hither 0' 'resolution 8 8' 'f 1 1 1 .8 0 0 0 1' \
        "$@" >"$name.nff"
}

yaml() {
    local name=$1
    shift
    printf '%s\n' "$@" >"$name.yaml"
}

# ---- commands and options ----

ends 0 --help
ends 0 --version
says '^raytally [0-9]+\.[0-9]+\.[0-9]+ commit: ([0-9a-f]{12}|unknown).* compiler: [A-Z][A-Za-z]+ [0-9].* accelerator libraries: (none|embree [34]\..*) kernels that run here: (portable|avx).* interface: [0-9]+, of plugins: [0-9]+ file format: [0-9]+ counts: [0-9]+ $'
ends 0 accels --json
refuses 'Usage: raytally COMMAND'
refuses "no command 'rendr': did you mean 'render'.*--help" rendr
refuses "no command 'bnch': did you mean 'bench'.*--help" help bnch
refuses "no command 'nonsense'.*--help" help nonsense
refuses "unrecognized option '--bogus'.*--help" accels --bogus
refuses "no accelerator 'grd': did you mean 'grid'.*raytally accels" accels grd
"$program" accels >/dev/full 2>stderr
[ $? = 2 ] && grep -q 'standard output' stderr || complain "raytally accels: a full disk goes unnoticed"
rm stderr
for command in $("$program" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z-]*\) .*/\1/p'); do
    ends 0 "$command" --help
    cmp -s <("$program" "$command" --help) <("$program" help "$command") ||
        complain "raytally help $command: says something other than raytally $command --help"
    refuses "unrecognized option '--bogus'.*$command --help" "$command" --bogus
    # An example that is wrapped cannot be pasted; it continues in an indented line.
    "$program" "$command" --help | awk '
        /[[:blank:]]$/ || (example && /^[^[:blank:]]/) { print "line " NR ": " $0; bad = 1 }
        { example = /^  raytally / }
        END { exit bad }' >wrapped || complain "raytally $command --help is wrapped badly: $(cat wrapped)"
    rm wrapped
done
[ -z "$("$program" --help | awk 'length > 80')" ] || complain "raytally --help exceeds 80 columns"
for command in render info convert; do
    refuses "raytally $command: .*raytally $command" $command
done
refuses 'one SCENE at a time' info balls balls
# shellcheck disable=SC2046 # nine options
refuses "--accel: 'bvh' is one too many: 8 at most" render balls $(printf -- '--accel bvh %.0s' {1..9}) -o balls.png
ends 0 info balls:size=1 --extents --rays 1000
ends 0 info balls:size=1 --extents=all --rays 1000 --json
refuses "extents: invalid value 'some'.*--extents=all" info balls --extents=some

# a scene without objects, and one with one
none=random:n=0
ends 0 info $none --extents --rays 10
"$program" info $none --json | python3 -c 'import json, sys; sys.exit(json.load(sys.stdin)["bounds"] is not None)' ||
    complain "raytally info $none --json: its bounds are not null"
ends 0 bench $none --accel wide --accel brute --rounds 1 --size 4x4
ends 0 render $none --accel bvh --size 4x4 -o none.png --structure boxes.png --stats none.json --check
ends 0 verify $none --accel kd --rays 10 --json
ends 0 rays $none --size 4x4 -o none.npy
ends 0 trace $none --pixel 0,0 --accel octree
for file in none.obj none.ply none.stl none.glb; do
    refuses 'the scene has none: write' convert $none $file
done
"$program" render random:n=1 --size 4x4 --depth 1 --threads 1 -o one.png | tr '\n' ' ' |
    grep -q ': 1 object, 2 lights.*, 1 level: .* on 1 thread: ' || complain 'raytally render: plurals of one'
rm ./none* boxes.png one.png
refuses "rays: invalid value '0'.*1\.\." info balls --extents --rays 0
refuses "rays: invalid value '1000000000000'.*1\.\." verify --rays 1000000000000
refuses "rays: invalid value '0'.*1\.\." verify --rays 0
refuses "no accelerator 'nope'" verify --accel nope
refuses 'nope\.nff: there is no such file' verify nope.nff

# ---- a full disk: exit code 2, a message that names the file, and no part of it ----

# full FILE ARGUMENT...: on a disk without a free byte
full() {
    local file=$1 message
    shift
    message=$( (trap '' XFSZ && ulimit -f 0 && timeout 60 "$program" "$@" </dev/null 2>&1 >/dev/null) || echo "exit code $?")
    [[ $message =~ $file.*": writing failed: ".*'exit code 2'$ ]] || complain "raytally $*: a full disk: $message"
    [ -z "$(find . -name "$file*")" ] || complain "raytally $*: a full disk: leaves $(find . -name "$file*" | xargs)"
}

small='balls:size=1 --size 8x8'
for arguments in '-o full.png' '--heatmap steps full.png' '--structure full.png' '--stats full.json'; do
    # shellcheck disable=SC2086
    full full. render $small $arguments
done
for arguments in '--csv full.csv' '--hits full.npy'; do
    # shellcheck disable=SC2086
    full full. bench $small --accel bvh --rays primary --count-only $arguments
done
# shellcheck disable=SC2086
full full.npy rays $small --rays primary -o full.npy
# shellcheck disable=SC2086
full full.svg trace $small --pixel 4,4 --svg full.svg
for format in yaml nff obj ply; do full full.$format convert tetra:size=1 full.$format; done
yaml full 'name: full' 'question: q' 'prediction: p' 'scenes: [{scene: "balls:size=1", size: 8x8}]' \
    'accelerators: [{accel: bvh}]' 'rays: [primary]' 'count_only: yes'
full experiment.yaml run full.yaml --out out
rm -r out

# ---- a folder in which nobody can make a file ----

# unmade FILE ARGUMENT...: FILE in /proc
unmade() {
    refuses "/proc/$1: creating the file failed" "${@:2}" "/proc/$1"
}

# shellcheck disable=SC2086
{
    unmade x.png render $small -o
    unmade x.json render $small --stats
    unmade x.svg trace $small --pixel 4,4 --svg
    unmade x.npy rays $small --rays primary -o
    unmade x.ply convert tetra:size=1
    unmade x.csv bench $small --accel bvh --rays primary --count-only --csv
}
refuses '/proc/out' run full.yaml --out /proc/out
refuses '/proc/out' verify tetra:size=1 --accel bvh --rays 10 --out /proc/out
refuses '/proc/mine' new-accel mine --out /proc
rm full.yaml

# ---- a dangling link is not a misspelt name ----

for name in link.nff link.yaml link.npy; do ln -s gone/away $name; done
refuses "link\.nff is a symbolic link to a missing file: its target is 'gone/away'" info link.nff
refuses "link\.yaml is a symbolic link to a missing file" run link.yaml
refuses "link\.npy is a symbolic link to a missing file" verify --replay link.npy
refuses "link\.npy is a symbolic link" bench balls:size=1 --accel bvh --rays nearest --rays-from link.npy
refuses "link\.nff is a symbolic link" bench link.nff --accel bvh
rm link.*

# ---- new-accel: a complete folder, or nothing ----

refuses 'a NAME .* is missing.*new-accel --help' new-accel
refuses 'one NAME at a time' new-accel mine yours
for name in '' '../mine' 'a b' '3d' '-x' 'mine;' 'grid:density=4' ünicode; do
    refuses "cannot be the name.*a letter, then letters, digits, '_' and '-'" new-accel -- "$name"
done
refuses "an accelerator 'grid' already exists" new-accel grid
refuses "'all' means every accelerator" new-accel all
refuses 'too long for a name' new-accel "$(printf 'a%.0s' {1..100})"
ends 0 new-accel my_grid-2
[ "$(ls my_grid-2)" = $'CMakeLists.txt\nREADME.md\nmy_grid-2.c' ] || complain "new-accel: makes $(ls my_grid-2)"
grep -rE 'my-accel|SPDX' my_grid-2 && complain "new-accel: leaves the name, or the licence, of its templates"
for file in CMakeLists.txt README.md my_grid-2.c; do
    grep -q 'my_grid-2' "my_grid-2/$file" || complain "new-accel: $file does not know its name"
done
refuses 'my_grid-2 already exists' new-accel my_grid-2
ends 0 new-accel mine --out some/where
[ -f some/where/mine/mine.c ] || complain 'new-accel: --out does not make its folder'
touch file
refuses 'file: this is not a directory' new-accel mine --out file
(ulimit -f 1 && trap '' XFSZ && "$program" new-accel cut) >stdout 2>stderr </dev/null
[ $? = 2 ] && grep -q 'writing failed' stderr && [ ! -e cut ] ||
    complain "new-accel: something half-written stays behind: $(ls cut): $(cat stderr)"
rm -r my_grid-2 some file stdout stderr

# ---- scenes: which files and which built-ins ----

refuses 'nope\.nff: there is no such file' render nope.nff -o x.png
refuses 'nope\.yaml: there is no such file' render nope.yaml -o x.png
refuses 'nope\.obj: there is no such file' render nope.obj -o x.png
refuses "'?bals'?.*did you mean '?balls" render bals -o x.png
refuses 'scene\.txt.*\.yaml.*\.nff' render scene.txt -o x.png
refuses 'size=1000000000.*1\.\.7' render balls:size=1000000000 -o x.png
refuses "siz.*size" render balls:siz=2 -o x.png
refuses 'a whole number' render balls:size=two -o x.png
refuses '0\.\.' render random:n=-1 -o x.png

# ---- scenes: their contents ----

nff empty
refuses 'empty\.nff: .*empty.*at least one object' render empty.nff -o x.png
nff nan 's 0 0 0 1' 's nan 0 0 1'
refuses 'nan\.nff:10: .*(finite|number)' render nan.nff -o x.png
nff infinite 's 1e39 0 0 1'
refuses 'infinite\.nff:9: .*float' render infinite.nff -o x.png
nff point 's 0 0 0 0'
refuses 'point\.nff:9: .*radius' render point.nff -o x.png
nff flat 's 0 0 0 1' 'p 3' '0 0 0' '1 1 1' '2 2 2'
refuses 'flat\.nff:10: .*(area|line|degenerate)' render flat.nff -o x.png
nff bent 'p 4' '0 0 0' '1 0 0' '1 1 5' '0 1 0'
refuses 'bent\.nff:9: .*plan' render bent.nff -o x.png
nff short 'p 3' '0 0 0' '1 0 0'
refuses 'short\.nff:11: ' render short.nff -o x.png
nff huge 'p 1000000000' '0 0 0' '1 0 0' '1 1 0'
refuses 'huge\.nff:(9|12): ' render huge.nff -o x.png
nff cone 'c' '0 0 0 0' '0 0 1 0'
refuses 'cone\.nff:9: .*radi' render cone.nff -o x.png
nff unknown 's 0 0 0 1' 'sphere 0 0 0 1'
refuses "unknown\.nff:10: .*sphere" render unknown.nff -o x.png
printf 's 0 0 0 1\n\0\377\n' >binary.nff
refuses 'binary\.nff' render binary.nff -o x.png
mkdir folder.nff
refuses 'folder\.nff is a folder' render folder.nff -o x.png

yaml key 'objects:' '  - sphere: {centre: [0, 0, 0], radius: 1}'
refuses "key\.yaml:2:.*centre.*center" render key.yaml -o x.png
yaml zero 'objects:' '  - sphere: {center: [0, 0, 0], radius: 0}'
refuses "zero\.yaml:2:.*radius" render zero.yaml -o x.png
yaml notnumber 'objects:' '  - sphere: {center: [0, 0, .nan], radius: 1}'
refuses "notnumber\.yaml:2:.*" render notnumber.yaml -o x.png
yaml line 'objects:' '  - polygon: {vertices: [[0, 0, 0], [1, 1, 1], [2, 2, 2]]}'
refuses "line\.yaml:2:.*(area|line|degenerate)" render line.yaml -o x.png
yaml none 'objects: []'
refuses "none\.yaml:.*object" render none.yaml -o x.png
yaml broken 'objects: [' '  - sphere'
refuses "broken\.yaml:2:" render broken.yaml -o x.png
yaml wide 'camera: {size: [1000000000, 1]}' 'objects:' '  - sphere: {center: [0, 0, 0], radius: 1}'
refuses "wide\.yaml:1:.*1\.\.32768" render wide.yaml -o x.png
yaml stuff 'objects:' '  - sphere: {center: [0, 0, 0], radius: 1, material: gold}'
refuses "stuff\.yaml:2:.*gold" render stuff.yaml -o x.png
: >nothing.yaml
refuses "nothing\.yaml" render nothing.yaml -o x.png

printf '%s\n' 'f 1 2 3' >bad.obj
refuses 'bad\.obj:1: .*vertex 1, but there are 0' render bad.obj -o x.png
printf '%s\n' 'v 0 0 0' 'v 1 0 0' 'v 0 1 0' 'f 1 2 9' >index.obj
refuses 'index\.obj:4: .*vertex 9' render index.obj -o x.png
printf '%s\n' 'v 0 0 0' 'v 1 0 0' 'v nan 1 0' 'f 1 2 3' >nan.obj
refuses 'nan\.obj:4: .*not finite' render nan.obj -o x.png
printf '%s\n' 'v 0 0 0' 'v 1 0 0' >points.obj
refuses 'points\.obj: .*no triangle' render points.obj -o x.png
printf '%s\n' ply 'format ascii 1.0' 'element vertex 1000000000' 'property float x' 'property float y' 'property float z' end_header >huge.ply
refuses 'huge\.ply:.*0 of the 1000000000 vertices' render huge.ply -o x.png
printf '%s\n' OFF '1000000000 1 0' '0 0 0' >huge.off
refuses 'huge\.off:3: .*1 of the 1000000000 vertices' render huge.off -o x.png
: >empty.ply
refuses "empty\.ply:1: .*begins with a line 'ply'" render empty.ply -o x.png

nff whole 's 0 0 0 1'
refuses "out\.xyz.*\.nff" convert whole.nff out.xyz
refuses 'missing/out\.yaml' convert whole.nff missing/out.yaml
refuses 'nope\.nff: there is no such file' convert nope.nff out.yaml

# ---- accelerators ----

refuses "'grd': did you mean 'grid'" render balls:size=1 --accel grd -o x.png
refuses "densty.*density" render balls:size=1 --accel grid:densty=4 -o x.png
refuses "density=1e9.*\.\." render balls:size=1 --accel grid:density=1e9 -o x.png
refuses "density.*twice" render balls:size=1 --accel grid:density=2,density=3 -o x.png
refuses "max_leaf_size=1000000000.*1\.\." render balls:size=1 --accel bvh:max_leaf_size=1000000000 -o x.png
refuses "max_leaf_size=" render balls:size=1 --accel bvh:max_leaf_size= -o x.png
refuses "NAME\[:KEY=VALUE" render balls:size=1 --accel '' -o x.png

# ---- sizes, numbers, outputs ----

refuses "1000000000x2.*1\.\.32768" render balls:size=1 --size 1000000000x2 -o x.png
refuses "0x0.*1\.\.32768" render balls:size=1 --size 0x0 -o x.png
refuses "1\.\.64" render balls:size=1 --depth 1000000000 -o x.png
refuses "1\.\.64" render balls:size=1 --samples 0 -o x.png
refuses "threads.*1\.\." render balls:size=1 --threads -1 -o x.png
refuses "nothing to do" render balls:size=1
refuses "ends in \.png" render balls:size=1 -o x.gif
refuses "missing/x\.png.*No such file" render balls:size=1 --size 8x8 -o missing/x.png
mkdir taken.png
refuses "taken\.png" render balls:size=1 --size 8x8 -o taken.png
refuses "teps.*steps" render balls:size=1 --size 8x8 --heatmap teps x.png
refuses "missing/x\.json.*No such file" render balls:size=1 --size 8x8 --stats missing/x.json

# ---- measuring ----

bench='bench balls:size=1 --size 8x8 --limit 50 --rounds 2'
refuses 'SCENE is missing' bench --accel bvh
refuses 'accelerator is missing' $bench
refuses 'nope\.nff: there is no such file' bench nope.nff --accel bvh
refuses "'grd': did you mean 'grid'" $bench --accel grd
refuses "'bhv': did you mean 'bvh'" $bench --accel bhv
refuses "'grid:best' is the fastest of several settings, which measuring chooses" verify balls:size=1 --accel grid:best
refuses 'bvh.*used twice: leave one out' $bench --accel bvh --accel bvh
refuses "'brute:best' is neither a spec" $bench --accel bvh --baseline brute:best
refuses "no ray kind 'sideways'.*primary" $bench --accel bvh --rays sideways
refuses 'primary.*twice' $bench --accel bvh --rays primary,primary
refuses 'rounds.*1\.\.1000' $bench --accel bvh --rounds 1000000000
refuses "until: invalid value '1'.*1%" $bench --accel bvh --until 1
refuses 'patience.*1\.\.' $bench --accel bvh --until 1% --patience 0
ends 0 $bench --accel bvh --until 100%
refuses 'limit.*1\.\.' $bench --accel bvh --limit 0
refuses 'rounds.*1\.\.1000' $bench --accel bvh --rounds 0
refuses 'milliseconds.*0\.\.60000' $bench --accel bvh --milliseconds 60001
refuses 'coherent-run.*1\.\.' $bench --accel bvh --coherent-run 0
refuses 'depth.*1\.\.64' $bench --accel bvh --depth 0
refuses 'ray-stride.*1\.\.' $bench --accel bvh --ray-stride 0
refuses 'depth.*1\.\.64' render balls:size=1 --depth 0 -o x.png
ends 0 $bench --accel bvh --seed 0 --count-only
refuses '--ray-stride comes after' $bench --ray-stride 2 --accel bvh
refuses 'missing/x\.csv.*No such file' $bench --accel bvh --csv missing/x.csv
ends 0 $bench --accel all --json
ends 0 $bench --accel brute --ray-stride 3 --accel bvh --baseline bvh --count-only
ends 0 $bench --accel bvh --rays diffuse,occlusion
yaml named 'name: ünï' 'question: q' 'prediction: p' 'scenes: [{scene: "balls:size=1"}]' 'accelerators: [{accel: bvh}]'
refuses 'named\.yaml:1:7: .*letters outside ASCII' run named.yaml --dry-run
yaml matte 'objects: [{sphere: {center: [0, 0, 0], radius: 1}}]'
ends 0 bench matte.yaml --accel bvh --size 4x4 --count-only --rays reflection,transmission
says 'matte: there are no rays to measure \(reflection, transmission\): no surface'
# Times per second are times per ray, multiplied by rays per second.
timeout 60 "$program" $bench --accel kd --accel grid --rays primary,shadow --json >seconds.json
awk -F '[":, ]+' '
    { value[$2] = $3 }
    $2 == "mtests_per_s" {
        rows++
        of_steps = value["msteps_per_s"] * value["rays"] / value["steps"] / value["mrays_per_s"]
        of_tests = value["mtests_per_s"] * value["rays"] / value["object_tests"] / value["mrays_per_s"]
        if (!(of_steps > 0.9999 && of_steps < 1.0001 && of_tests > 0.9999 && of_tests < 1.0001)) exit 1
    }
    END { exit rows != 4 }' seconds.json || complain "bench --json: steps and tests a second are not those of a ray"

# The table fits a terminal, names its baseline, and says why a ratio on some of the rays differs.
long=wide:in_flight=1,packets=0,order=off
"$program" $bench --accel bvh --accel brute --ray-stride 7 --accel $long --rays primary,shadow >table 2>&1
awk 'length > 80 { exit 1 }' table || complain "bench: the table has lines of more than 80 characters"
for says in 'size=1: 11 objects, 8x8, depth 5, seed 1' 'relative to bvh, .* of 2 rounds, with 50 %' '^confidence intervals' \
    '^  shadow, [0-9]* rays' '^brute \* ' '^\* brute is measured on one in 7 rays' '^wide:in_flight=1,packets=0,' '^bvh (again) '; do
    grep -q "$says" table || complain "bench: the table does not say '$says'"
done
"$program" $bench --accel bvh --accel brute --ray-stride 7 --accel $long --rays primary,shadow --count-only >table 2>&1
awk 'length > 80 { exit 1 }' table || complain "bench --count-only: the table has lines of more than 80 characters"
for says in '^accelerator .*MB  interior  leaves' '^\* brute is measured on one in 7 rays.$'; do
    grep -q "$says" table || complain "bench --count-only: the table does not say '$says'"
done
! grep -E ' (ms|ratio|Mrays|-)( |$)' table || complain "bench --count-only: the table has columns of times"
"$program" $bench --accel bvh --rays primary --seed 9 --json >seconds.json
for says in '"seed": 9' '"rounds": 2' '"width": 8' '"baseline": "bvh"' '"ns_low": [0-9]' '"straddles_1": [tf]'; do
    grep -q "$says" seconds.json || complain "bench --json: does not say '$says'"
done
"$program" bench 'balls:size=1|2' --size 8x8 --rounds 2 --accel bvh --rays primary --json >seconds.json
for says in '"scene": "balls:size=1"' '"scene": "balls:size=2"'; do
    [ "$(grep -c "$says" seconds.json)" = 3 ] || complain "bench --json: scenes, rows and null runs are not each of $says"
done
rm table seconds.json
refuses 'one SCENE at a time' rays 'balls:size=1|2' --size 8x8 -o rays.npy

for subject in '' 'a' 'a b c' 'a b --with c' 'a b --accel bvh' 'a b --until 1%' 'a b --rounds 9' 'a b --size 8x8'; do
    refuses 'raytally compare: ' compare $subject
done
refuses "margin: invalid value '3'" compare a b --margin 3
refuses 'there is no directory nowhere' compare nowhere nowhere
mkdir begun
refuses 'begun is not a finished result directory.*raytally run EXPERIMENT --out begun --resume' compare begun begun
refuses 'an EXPERIMENT defines its rays' compare a.yaml --rays primary --with "$program"
refuses 'no/such: cannot be started: No such file' compare balls:size=1 --accel bvh --size 8x8 --with no/such
refuses '/bin/true cannot be compared' compare balls:size=1 --accel bvh --size 8x8 --with /bin/true
refuses '/bin/cat cannot be compared' compare balls:size=1 --accel bvh --size 8x8 --with /bin/cat
refuses "'grd': did you mean 'grid'" compare balls:size=1 --accel grd --with "$program"

refuses 'EXPERIMENT is missing' run
refuses 'nope\.yaml: .*No such file' run nope.yaml
yaml wrong 'name: wrong' 'questoin: why'
refuses 'wrong\.yaml:2:.*question' run wrong.yaml
yaml absent 'name: a' 'question: b' 'prediction: c' 'scenes: [{scene: absent.obj}]' 'accelerators: [{accel: bvh}]'
refuses 'absent\.obj: there is no such file; .*fetch\.sh' run absent.yaml
for command in plot report reproduce; do
    refuses 'DIR is missing' $command
    refuses 'there is no directory nowhere' $command nowhere
    refuses 'begun is not a finished result directory' $command begun
done
ends 0 info family:kind=slivers,seed=7
ends 0 render family:kind=csg,seed=7 --size 8x8 -o family.png
ends 0 convert family:kind=shared,seed=7 family.yaml
refuses "no built-in scene 'famly': did you mean 'family'" scenes famly
refuses 'empty|one-sphere' info family:kind=
ends 0 verify tetra:size=1 --accel bvh --rays 10 --out verified
mkdir 'a folder'
printf '%s\n' 'v 0 0 0' 'v 1 0 0' 'v 0 1 0' 'f 1 2 3' | tee 'my scene.obj' 'a folder/Größe & Co.obj' >/dev/null
for scene in 'my scene.obj' 'a folder/Größe & Co.obj'; do
    ends 0 info "$scene"
    ends 0 render "$scene" --size 8x8 -o blank.png
    ends 0 bench "$scene" --accel bvh --size 8x8 --count-only --csv blank.csv
    ends 0 verify "$scene" --accel bvh --rays 10 --out "${scene%.obj} verified"
    ends 0 convert "$scene" "${scene%.obj}.yaml"
    yaml blank 'name: blank' 'question: b' 'prediction: c' "scenes: [{scene: '$scene'}]" 'accelerators: [{accel: bvh}]' \
        'count_only: true'
    ends 0 run blank.yaml --force
    ends 0 reproduce results/blank
done
refuses 'verified is not the result directory of an experiment' report verified

# reproduce says what it did not compare, and why counts differ
printf '%s\n' 'v 0 0 0' 'v 1 0 0' 'v 0 1 0' 'f 1 2 3' >one.obj
yaml mesh 'name: mesh' 'question: b' 'prediction: c' 'scenes: [{scene: one.obj, optional: yes}, {scene: "balls:size=1", size: 8x8}]' \
    'accelerators: [{accel: bvh}]' 'count_only: true'
ends 0 run mesh.yaml
mv one.obj two.obj
ends 2 reproduce results/mesh
says "the other scenes in results/mesh/counts\.csv, byte for byte.*'one' was not compared, because its scene is missing here"
refuses "'one' was not compared" reproduce results/mesh --only one
ends 0 reproduce results/mesh --only balls:size=1
yaml prefix 'name: prefix' 'question: b' 'prediction: c' 'scenes: [{scene: "random:n=10", size: 8x8}, {scene: "random:n=10,seed=2", size: 8x8}, {scene: "tetra:size=1", label: scene, size: 8x8}]' \
    'accelerators: [{accel: bvh}]' 'count_only: true'
ends 0 run prefix.yaml
for scene in random:n=10 random:n=10,seed=2 scene; do ends 0 reproduce results/prefix --only $scene; done
sed 's/v 1 0 0/v 2 0 0/' two.obj >one.obj
ends 1 reproduce results/mesh
says "the scene 'one' has changed: its fingerprint was [0-9a-f]{16}, and is [0-9a-f]{16} here"
rm printed said

# ---- correct input passes: the same scenes without their mistake ----

nff right 's 0 0 0 1' 'p 3' '0 0 0' '1 0 0' '1 1 0' 'c' '0 0 0 1' '0 0 1 1'
ends 0 render right.nff -o x.png
[ -s x.png ] || complain "raytally render right.nff -o x.png: makes no picture"
yaml right 'objects:' '  - sphere: {center: [0, 0, 0], radius: 1}'
ends 0 render right.yaml --size 8x8 -o y.png

mkdir damaged && echo '{' >damaged/manifest.json
refuses 'damaged/manifest\.json:2: .*run the experiment again' reproduce damaged

yaml small 'name: small' 'question: b' 'prediction: c' 'scenes: [{scene: "balls:size=1", size: 8x8}]' \
    'accelerators: [{accel: bvh}, {accel: brute}]' 'limit: 50' 'rounds: 2' 'milliseconds: 1'
: >occupied
refuses 'occupied.*(directory|folder)' run small.yaml --out occupied
ends 0 run small.yaml
ends 0 run small.yaml --resume
ends 0 reproduce results/small
refuses 'there is nothing to compare: no scene, accelerator and kind of rays is in both' compare results/small results/blank
mv small.yaml away.yaml
ends 0 reproduce results/small # by its own copy
refuses 'small\.yaml cannot be read here: start raytally in the folder in which results/small was measured' run results/small/manifest.json
mv away.yaml small.yaml
ends 0 run results/small/manifest.json --out again
cmp -s results/small/counts.csv again/counts.csv || complain "raytally run DIR/manifest.json: does not count the same"
refuses "quick: .*manifest.json says" run results/small/manifest.json --quick --out again
cp small.yaml kept.yaml && sed -i 's/limit: 50/limit: 40/' small.yaml
"$program" run results/small/manifest.json --force 2>stderr && complain "raytally run DIR/manifest.json: runs what has changed"
grep -q 'small.yaml has changed since results/small was made' stderr || complain "run DIR/manifest.json: $(cat stderr)"
rm stderr
mv kept.yaml small.yaml
echo '{}' >damaged/manifest.json
refuses 'does not say what was run' run damaged/manifest.json
cp results/small/counts.csv counted
# differs WHERE THERE NOW: from the current counts
differs() {
    "$program" reproduce results/small >stdout 2>stderr && complain "raytally reproduce: takes counts that differ"
    message=$(tr '\n' ' ' <stderr)
    [[ $message =~ counts\.csv:$1:.*there:\ *$2\ *now:\ *$3\ *$ ]] ||
        complain "raytally reproduce: does not say that line $1 has '$2', not '$3': $message"
    cp counted results/small/counts.csv
}
lines=$(wc -l <counted) last=$(tail -n 1 counted)
sed -i '$s/,50,/,49,/' results/small/counts.csv
differs "$lines" "${last/,50,/,49,}" "$last"
echo >>results/small/counts.csv
differs $((lines + 1)) '' '\(nothing more\)'
sed -i '$d' results/small/counts.csv
differs "$lines" '\(nothing more\)' "$last"
head -c -1 counted >results/small/counts.csv
differs "$lines" "$last \(without an end of line\)" "$last"

conclude
