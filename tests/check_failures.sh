#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_failures.sh [--all] [WORD...]: whatever fails in a command, it ends with exit code 2 and a message, or does without; it
# never crashes, hangs, or leaves a temporary or half-written file, and frees what it allocated. The nth allocation of raytally
# and of each library fails (tests/failing_alloc.c), the nth system call that reads, writes, opens, renames, synchronises or
# creates something (strace), and SIGTERM comes at the nth of them. Each n with --all, which takes hours; else one by chance, the
# same every time. WORD: only what fails in commands or ways that contain it, such as `render`, `alloc` or `rename`.
#
# Libraries that raytally cannot keep from ending the process, or from carrying on, are left out:
# - libgmp aborts by design (its manual, "Custom Allocation");
# - pixman, below cairo, writes to memory that it did not get; cairo, writing SVG, leaves out what it has no memory for while its
#   status is success (33 of its 254 allocations), and crashes at one;
# - TBB, which Embree builds with, throws C++ exceptions where nobody can catch them: memory of libstdc++, and threads that
#   Embree cannot start;
# - fontconfig, freetype, expat and the loader of libraries do without, or with another font, and do not say so; fontconfig
#   crashes without what libc allocates for it, in commands that draw text;
# - gnuplot takes a read of its script that fails for the end of the script, and says nothing: the plot lacks the rest.
# Without Embree, gnuplot or what the system says of the processor, results are the same but for that.
source "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
preload=$(dirname "$program")/failing_alloc.so
command -v strace >/dev/null && [ -e "$preload" ] || { echo "skipped: whatever fails, nothing is half-written; needs strace" && exit 77; }
all=
[ "${1-}" != --all ] || { all=1 && shift; }
RANDOM=7
words=("$@")
tried=0
export LC_ALL=C

# ---- what the commands work on ----

mkdir "$work/input" && cd "$work/input"
cat >small.yaml <<'END'
name: small
question: q
prediction: p
scenes: [{scene: "random:n=30", label: cloud, size: 6x6}, {scene: "tetra:size=1", size: 6x6}]
accelerators: [{accel: bvh}, {accel: "grid:density=1|4"}]
rays: [primary, shadow]
limit: 20
count_only: yes
END
ends 0 convert balls:size=1 scene.yaml
ends 0 convert balls:size=1 scene.nff
ends 0 convert tetra:size=1 mesh.obj
ends 0 rays balls:size=1 --size 6x6 --rays primary -o rays.npy
ends 0 rays balls:size=1 --size 6x6 --rays primary -o rays.csv
ends 0 bench scene.yaml --accel bvh --rays-from rays.npy --rays nearest --count-only --hits hits.csv
ends 0 run small.yaml --out done --threads 1
ends 0 run small.yaml --out part --threads 1 --only cloud
cp -a done again
for i in 1 2; do ends 0 run small.yaml --out shard$i --threads 1 --shard $i/2; done
rm printed said

frame='--size 6x6'
commands=(
    'accels --json'
    'scenes'
    'info scene.yaml --json'
    'info scene.nff'
    'info mesh.obj'
    'convert mesh.obj out.ply'
    'convert scene.nff out.yaml'
    "render scene.yaml $frame -o out.png --stats out.json --heatmap steps heat.svg"
    "render scene.yaml $frame --accel grid -o out.png --structure cells.svg"
    "render scene.yaml $frame --accel embree -o out.png"
    "trace scene.yaml $frame --pixel 3,3 --svg out.svg"
    "trace scene.yaml $frame --pixel 3,3 --depth 3 --json"
    "explore scene.yaml $frame -o out.html"
    "rays scene.yaml $frame --rays primary -o out.npy --threads 1"
    "bench scene.yaml $frame --accel bvh --accel item+light+octree --rays primary,shadow --count-only --csv out.csv --json --threads 1"
    'bench scene.yaml --accel kd --rays-from rays.npy --rays nearest --count-only --hits out.npy --threads 2'
    'verify scene.yaml --accel bvh --accel wide --rays 20 --threads 1 --out checked'
    'verify scene.yaml --rays-from rays.csv --hits-from hits.csv --differing-rays out.npy --threads 1 --json'
    'trace scene.yaml --ray rays.npy:7 --depth 2 --json'
    'verify mesh.obj --accel embree:mode=user --rays 20 --threads 1 --json'
    'run small.yaml --out out --threads 1'
    'run small.yaml --out part --threads 1 --resume'
    'merge shard1 shard2 --out out'
    'report done'
    'plot done'
    'reproduce done'
    'compare done again --json'
    'new-accel mine'
)

# ---- one try ----

# Without what differs from one run to the next, or names the machine.
steady() { sed -E -e '/second|mrays|date|built in| s on |build_|clock|cpu|processor|embree|gnuplot/d' -e 's/( +[<0-9.e-]+){2} +-$//' "$@"; }

# begins COMMAND: in a fresh copy of the input
begins() {
    rm -rf "$work/trial" && cp -a "$work/input" "$work/trial" && cd "$work/trial"
    arguments=$1
}

# whole WHERE: what is in the folder was there, or is what the command writes
whole() {
    local left path
    left=$(find . -name '*.tmp' -o -name '*.tmp.*')
    [ -z "$left" ] || complain "$1: leaves $left"
    while read -r path; do
        cmp -s "$path" "$work/input/$path" && continue
        case $path in
        *.csv) # of a run that ended early: some of the rows
            [ -z "$(tail -c 1 "$path")" ] && ! grep -qvxFf "$work/good/$path" "$path" || complain "$1: half-written: $path" ;;
        *.svg) [ "${what-}" = read ] || cmp -s "$path" "$work/good/$path" || complain "$1: half-written: $path" ;;
        *.npy | *.ply | *.png | *.yaml | *.c)
            cmp -s "$path" "$work/good/$path" || complain "$1: half-written: $path" ;;
        *.html) grep -q '</html>' "$path" || complain "$1: half-written: $path" ;;
        *.json) [ "$(tail -c 2 "$path")" = '}' ] || complain "$1: half-written: $path" ;;
        esac
    done < <(find . -type f | sed 's/^..//')
}

# list FOLDER: its files, except plots that are drawn if gnuplot can
list() { (cd "$1" && find . -type f ! -name '*.pdf' ! -path '*/plots/*' | sort); }

# judge WHERE CODE: after a failure
judge() {
    tried=$((tried + 1))
    case $2 in
    0)
        [ "$(steady ../printed)" = "$(cat "$work/expected")" ] || complain "$1: exit code 0, but the output differs"
        [ "$(list .)" = "$(list "$work/good")" ] || complain "$1: exit code 0, but files differ"
        ;;
    2) [ -s ../said ] || [ "${silent-}" ] || complain "$1: exit code 2 without a message" ;;
    1) grep -q 'gnuplot failed' ../said || complain "$1: exit code 1: $(tail -n 3 ../said)" ;;
    124) complain "$1: hangs" ;;
    *) complain "$1: exit code $2: $(tail -n 3 ../said)" ;;
    esac
    whole "$1"
}

# choose LAST [FIRST]: to `chosen`, all n from FIRST to LAST or one
choose() {
    local first=${2:-1}
    chosen=$((first + RANDOM % ($1 - first + 1)))
    [ -z "$all" ] || chosen=$(seq "$first" "$1")
}

# wanted TEXT: it contains one of the words
wanted() {
    local word
    [ ${#words[@]} -gt 0 ] || return 0
    for word in "${words[@]}"; do [[ $1 != *"$word"* ]] || return 0; done
    return 1
}

# ---- allocations ----

allocations() {
    local library count n live code
    export LD_PRELOAD=$preload RT_FAIL_LOG=$work/log RT_FAIL_IN='' RT_FAIL_AT=0
    begins "$1" && rm -f "$work/log"
    # shellcheck disable=SC2086
    "$program" $1 >../printed 2>../said </dev/null || true
    LD_PRELOAD='' cp "$work/log" "$work/calls"
    unset LD_PRELOAD
    live=$(awk '/^live/ { print $2 }' "$work/calls")
    [ "$live" = 0 ] || complain "raytally $1: $live blocks are not freed"
    while read -r _ library count; do
        case $library in libgmp.* | libpixman* | libstdc++.* | libembree* | libfontconfig.* | libfreetype.* | libexpat.* | ld-linux* | libtbb*) continue ;; esac
        [[ $library != libc.* && $library != libcairo.* ]] || [[ $1 != *.svg* ]] || continue
        wanted "$1 alloc $library" || continue
        choose "$count"
        for n in $chosen; do
            begins "$1" && rm -f "$work/log" && code=0
            # shellcheck disable=SC2086
            LD_PRELOAD=$preload RT_FAIL_IN=$library RT_FAIL_AT=$n timeout 20 "$program" $1 >../printed 2>../said </dev/null || code=$?
            judge "raytally $1: allocation $n of $library fails" "$code"
            live=$(awk '/^live/ { print $2 }' "$work/log" 2>/dev/null || true)
            [ "${live:-0}" = 0 ] || [ "$code" -gt 2 ] || complain "raytally $1: allocation $n of $library fails: $live blocks are not freed"
        done
    done < <(grep ^calls "$work/calls")
}

# ---- system calls ----

# A line each: what, the error, the calls; + if all later ones fail, too, as on a full disk.
ways='read EIO read,pread64
write ENOSPC write,writev,pwrite64 +
open EMFILE openat
sync EIO fsync,fdatasync
rename ENOSPC rename,renameat,renameat2
mkdir ENOSPC mkdir,mkdirat
fork EAGAIN clone,clone3,fork,vfork'

# traced OPTION...: the command under strace, to ../trace
traced() {
    # shellcheck disable=SC2086
    timeout 30 strace --seccomp-bpf -f -qq -o ../trace "$@" "$program" $arguments >../printed 2>../said </dev/null
}

# The calls so far when the last library is loaded, and all of them.
counts() {
    awk -v names="$1" '
        BEGIN { split(names, list, ","); for (i in list) is[list[i]] = 1 }
        { split($2, call, "(") }
        call[1] in is { count[$1]++; if ($1 == first || !first) { first = $1; mine++ } if (count[$1] > most) most = count[$1] }
        /\.so/ && $2 ~ /^openat/ && !/ENOENT/ { seen = 1; loaded = mine + 2 }
        END { print loaded + 0, most + 0 }' ../trace
}

system_calls() {
    local what error names code n loaded most on
    while read -r what error names on; do
        wanted "$1 $what" || continue
        begins "$1"
        traced -e "trace=openat,$names" || true
        read -r loaded most < <(counts "$names")
        [ "$what" = read ] || [ "$what" = open ] || loaded=0
        [ "$most" -gt "$loaded" ] || continue
        choose "$most" $((loaded + 1))
        for n in $chosen; do
            begins "$1" && code=0
            [ "$what" != fork ] || [[ $1 != *embree* ]] || continue
            traced -e "trace=$names" -e "inject=$names:error=$error:when=$n$on" || code=$?
            grep -q INJECTED ../trace || continue # fewer calls than the first time
            silent=$(grep -E 'write\(2,.*INJECTED' ../trace || true)
            judge "raytally $1: $what $n fails" "$code"
        done
    done <<<"$ways"
    silent=
}

signals() {
    local names n code most loaded
    names=$(cut -d ' ' -f 3 <<<"$ways" | paste -s -d ,)
    wanted "$1 signal" || return 0
    begins "$1"
    traced -e "trace=$names" || true
    read -r loaded most < <(counts "$names")
    choose "$most" $((loaded + 1))
    for n in $chosen; do
        begins "$1" && code=0
        traced -e "trace=$names" -e "inject=$names:signal=TERM:when=$n" || code=$?
        grep -q 'SIGTERM.*SI_' ../trace || continue # fewer calls than the first time
        [ "$code" != 143 ] || code=2 silent=1
        judge "raytally $1: SIGTERM at call $n" "$code"
        silent=
    done
}

for command in "${commands[@]}"; do
    [[ $command != *embree* ]] || "$program" accels embree >/dev/null 2>&1 || continue
    begins "$command"
    # shellcheck disable=SC2086
    "$program" $command >../printed 2>../said </dev/null || complain "raytally $command: $(cat ../said)"
    steady ../printed >"$work/expected"
    rm -rf "$work/good" && cp -a . "$work/good"
    allocations "$command"
    system_calls "$command"
    signals "$command"
done
echo "$tried failures were tried"
conclude
