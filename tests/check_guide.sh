#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_guide.sh [--slow] [DOCUMENT...]: runs the commands of docs/guide/*.md and docs/accelerators/*.md, or of the named
# documents (a folder names all in it). Uses $RT_PROGRAM. The blocks of a document run in order in one scratch directory with
# copies of docs/, examples/, experiments/, results/ and scenes/:
#   ```sh                 run by bash, -euo pipefail; `raytally` is in PATH; must end with exit code 0
#   ```sh exit=1          must end with exit code 1
#   ```sh slow            run only with --slow, by hand
#   ```sh needs=X         run only if X exists: numpy, embree, library (installed to $PREFIX from beside $RT_PROGRAM), a
#                         file of the tree (X has a /), or else a command
#   ```text exact         counts, the same on every machine: the output of the previous block; a line ... matches some lines
#   ```text               any other output, which is not compared
#   ```LANG file=NAME     is written to NAME first
# Links into the tree must exist. Prints all failures, and how many blocks were run, compared and skipped; exit
# code 1 if anything failed.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
here=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 2
root=$PWD
[ -x "$program" ] || { echo "check_guide: no program $program" >&2 && exit 2; }
mkdir "$work/bin" && ln -s "$program" "$work/bin/raytally"
export PATH=$work/bin:$PATH
slow=no patience=300 ran=0 compared=0 left_slow=0 lacking=()

# available X: for needs=X
available() {
    case $1 in
    numpy)
        local python
        python=$(python_with_numpy) || return
        [ "$python" = "$(command -v python3)" ] || ln -s "$python" "$work/bin/python3"
        ;;
    embree) raytally info balls:size=1 >/dev/null && raytally render balls:size=1 --size 2x2 --accel embree -o "$work/x.png" >/dev/null 2>&1 ;;
    library) # and the tools to link with it
        command -v cc >/dev/null && command -v pkg-config >/dev/null || return
        export PREFIX=$work/prefix PKG_CONFIG_PATH=$work/prefix/lib/pkgconfig PYTHONPATH=$work/prefix/lib/python3/dist-packages
        [ -d "$PREFIX" ] && return
        cmake --install "$(dirname "$program")" --prefix "$PREFIX" >/dev/null 2>&1 && PATH=$PREFIX/bin:$PATH
        ;;
    */*) [ -e "$root/$1" ] ;;
    *) command -v "$1" >/dev/null ;;
    esac
}

# as_expected EXPECTED GOT: the same lines, except blank ones at the end; a line ... in EXPECTED matches some lines
as_expected() {
    local pattern got
    pattern=$(sed -E 's/[][*?\\]/\\&/g; s/^\.\.\.$/*/' "$1")
    got=$(cat "$2")
    # shellcheck disable=SC2053 # it is a pattern
    [[ $got == $pattern ]]
}

# run_block PLACE WORD...: runs $work/block; sets $work/printed and `last`
run_block() {
    local place=$1 word expected=0 code=0
    shift
    last=skipped
    for word; do
        case $word in
        slow) [ "$slow" = yes ] || { left_slow=$((left_slow + 1)) && return; } ;;
        exit=*) expected=${word#exit=} ;;
        needs=*) available "${word#needs=}" || { lacking+=("${word#needs=}") && return; } ;;
        *) complain "$place: '$word' is not a word that a block of sh can have: slow, exit=N, needs=X" ;;
        esac
    done
    last=ran ran=$((ran + 1))
    (cd "$scratch" && exec timeout "$patience" bash -euo pipefail "$work/block") >"$work/printed" 2>&1 </dev/null || code=$?
    [ "$code" = "$expected" ] || complain "$place: exit code $code, not $expected:
$(tail -n 20 "$work/printed")"
}

# compare_block PLACE: compares $work/block with the output
compare_block() {
    [ "$last" = ran ] || { [ "$last" = skipped ] || complain "$1: no command stands before this output" && return; }
    compared=$((compared + 1))
    as_expected "$work/block" "$work/printed" || complain "$1: not what its command prints:
$(diff "$work/block" "$work/printed")"
}

# end_block PLACE WORD...: the words after the fence
end_block() {
    local place=$1 language=${2-} name=''
    shift $(($# > 1 ? 2 : 1))
    case "$language ${*-}" in
    *" file="*)
        name=${*##*file=} name=${name%% *}
        cp "$work/block" "$scratch/$name"
        ;;
    "sh"*) run_block "$place" "$@" ;;
    "text exact") compare_block "$place" ;;
    "text "?*) complain "$place: output is 'text' or 'text exact', not 'text $*'" ;;
    esac
    [ "$language" = sh ] || last=''
}

check_document() {
    local document=$1 number=0 line place='' words=()
    last='' scratch=$work/scratch
    rm -rf "$scratch" && mkdir "$scratch"
    for folder in docs examples experiments results scenes; do
        [ ! -d "$root/$folder" ] || cp -r "$root/$folder" "$scratch/"
    done
    while IFS= read -r line || [ -n "$line" ]; do
        number=$((number + 1))
        if [ -n "$place" ]; then
            if [ "$line" = '```' ]; then
                end_block "$place" ${words[@]+"${words[@]}"}
                place=''
            else
                printf '%s\n' "$line" >>"$work/block"
            fi
        elif [[ $line == '```'* ]]; then
            place=$document:$number
            read -ra words <<<"${line#'```'}"
            : >"$work/block"
        elif [[ $line =~ ^[[:space:]]+'```sh' ]]; then
            complain "$document:$number: an indented block is not run: begin it in the first column"
        fi
    done <"$document"
    [ -z "$place" ] || complain "$place: this block has no end"
}

[ "${1-}" != --slow ] || { slow=yes patience=1800 && shift; }
if [ $# -gt 0 ]; then
    documents=()
    for document; do
        document=$(cd "$here" && realpath "$document")
        if [ -d "$document" ]; then documents+=("$document"/*.md); else documents+=("$document"); fi
    done
else
    shopt -s nullglob
    documents=(docs/guide/*.md docs/accelerators/*.md)
fi
for document in "${documents[@]}"; do
    check_document "$document"
    check_links "$document"
done

echo "${#documents[@]} documents: $ran commands run, $compared outputs compared, $left_slow slow ones left out"
[ ${#lacking[@]} = 0 ] || printf '%s\n' "${lacking[@]}" | sort | uniq -c | while read -r count what; do
    echo "$count left out for want of $what"
done
[ $failures = 0 ] && [ "$ran" -gt 0 ]
