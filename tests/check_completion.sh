#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_completion.sh [bash|zsh|fish]: the output of `raytally completion SHELL` completes commands, options, accelerators, scenes and
# their parameters; the function of bash, the default, and of zsh is called as the shell calls it. Uses $RT_PROGRAM. Skipped (77) without
# the shell.
set -uo pipefail
shell=${1-bash}
program=$(realpath "${RT_PROGRAM:-build/release/raytally}")
command -v "$shell" >/dev/null || { echo "skipped: completion in $shell; needs $shell" && exit 77; }
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
mkdir folder bin && touch mine.yaml 'our scene.yaml'
ln -s "$program" bin/raytally && PATH=$work/bin:$PATH
failures=0
raytally completion "$shell" >script || exit 1

# complete_line LINE: sets COMPREPLY to what may replace the last word, or what follows the last : or = in it
case $shell in
bash)
    # shellcheck disable=SC1091
    source ./script || exit 1
    # Outside a completion bash has no compopt: its options go to `told`.
    compopt() { told="$told $2"; }
    # Words are split as by readline: at blanks without a backslash, which stays; : and = are words of their own.
    complete_line() {
        local parted
        COMP_LINE=$1 COMP_POINT=${#1} COMPREPLY=() told=''
        parted=$(sed -E 's/[:=]+/ & /g; s/\\ /\\\t/g' <<<"$1")
        IFS=' ' read -ra COMP_WORDS <<<"$parted"
        COMP_WORDS=("${COMP_WORDS[@]//$'\t'/ }")
        case $1 in *' ') COMP_WORDS+=('') ;; esac
        COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
        _raytally
    }
    ;;
zsh)
    # Outside a completion zsh has none of these functions: what they get is printed.
    cat >complete <<'END'
compdef() { : }
compset() { : }
compadd() { while [[ $1 != -- ]] shift; print -rl -- "${@:2}" }
_files() { local word=${(Q)words[CURRENT]}; print -rl -- ${word#--*=}*(N) }
source ./script
words=(${(z)1})
[[ $1 == *[^\\]' ' ]] && words+=('')
CURRENT=$#words
_raytally
END
    complete_line() { take_words "$1" < <(zsh -f complete "$1"); }
    ;;
fish)
    echo 'source script; complete -C $argv[1]' >complete
    complete_line() { take_words "$1" < <(HOME=$work fish --no-config complete "$1" | cut -f 1 | tr -d '\\' | sed 's|/$||'); }
    ;;
*) echo "check_completion.sh [bash|zsh|fish]" >&2 && exit 2 ;;
esac

# take_words LINE: COMPREPLY from whole words on stdin
take_words() {
    local word=${1##* } each
    COMPREPLY=()
    while IFS= read -r each; do
        [ -z "$each" ] || COMPREPLY+=("${each#"${word%"${word##*[:=]}"}"}")
    done
}

# offers LINE WORD...: these words, among others
offers() {
    local word all
    complete_line "$1"
    printf -v all '\n%s' "${COMPREPLY[@]}"
    for word in "${@:2}"; do
        [[ $all$'\n' == *$'\n'"$word"$'\n'* ]] || {
            echo "'$1' is not completed by '$word' but by '${COMPREPLY[*]}'"
            failures=$((failures + 1))
        }
    done
}

# offers_only LINE WORD...: exactly these words
offers_only() {
    offers "$@"
    [ ${#COMPREPLY[@]} = $(($# - 1)) ] || {
        echo "'$1' is completed by '${COMPREPLY[*]}'"
        failures=$((failures + 1))
    }
}

offers 'raytally ' accels bench render completion help --version
offers_only 'raytally be' bench
offers_only 'raytally help ver' verify
offers 'raytally bench --' --accel --count-only --rays --until --help
offers_only 'raytally bench --count' --count-only --counts
offers_only 'raytally bench --worker' # hidden
offers 'raytally bench balls --accel ' brute bvh grid octree item+ all
offers 'raytally bench balls -a ' brute bvh
offers_only 'raytally bench balls --accel gr' grid
offers_only 'raytally bench balls --accel=gr' grid
offers 'raytally bench balls --accel=' kd all
offers_only 'raytally bench balls --accel grid:dens' density=
offers 'raytally bench balls --accel grid:' density= mailbox= rule=
offers_only 'raytally bench balls --accel grid:mailbox=' on off
offers_only 'raytally bench balls --accel=grid:mailbox=of' off
offers_only 'raytally bench balls --accel grid:mailbox=on,dep' on,depth=
offers_only 'raytally bench balls --accel item+bv' item+bvh
offers 'raytally bench balls --accel item:isa=best+bvh:' build=
offers_only 'raytally bench balls --accel item:isa=best+bvh:build=sw' sweep
offers_only 'raytally bench tet' tetra
offers 'raytally info ' balls stadium mine.yaml
offers_only 'raytally info mi' mine.yaml
offers_only 'raytally info balls:' size=
offers_only 'raytally info family:kind=sli' slivers slivers-scaled
offers_only 'raytally bench balls --rays shadow,dif' shadow,diffuse
offers_only 'raytally verify --rays ' # a number
offers_only 'raytally accels oct' octree
offers_only 'raytally scenes sta' stadium
offers_only 'raytally render balls --heatmap object_t' object_tests
offers_only 'raytally render balls --heatmap-scale ' linear log
offers_only 'raytally trace balls --rays sha' shadow
offers_only 'raytally run mi' mine.yaml
offers_only 'raytally completion ' bash zsh fish
offers_only 'raytally new' new-accel
offers_only 'raytally new-accel mine --out fol' folder
offers_only 'raytally nonsense --'

offers_only 'raytally info our' 'our scene.yaml'
offers_only 'raytally info our\ sc' 'our scene.yaml'
offers_only 'raytally run --out=fol' folder
offers_only 'raytally render balls --le' --level --leaves

# Every option that --help lists, except argp's own.
for command in $(raytally --help | sed -n '/^Commands:/,/^$/s/^  \([a-z-]*\) .*/\1/p'); do
    # shellcheck disable=SC2046 # options are words
    offers "raytally $command --" $(raytally "$command" --help | grep -oE '^(  -., |      )--[a-z-]+' | grep -o -e '--.*')
done

[ "$shell" = bash ] || exit $((failures > 0))

# tells LINE WHAT: compopt was told to add no blank, or to treat words as paths
tells() {
    complete_line "$1"
    [ "$told" = "$2" ] || {
        echo "'$1' tells compopt '$told', not '$2'"
        failures=$((failures + 1))
    }
}
tells 'raytally info fol' ' filenames'
tells 'raytally info our' ' filenames'
tells 'raytally info tet' ''
tells 'raytally bench balls --accel fol' ''
tells 'raytally bench balls --accel grid:dens' ' nospace'

# Words are no file patterns: --level=A[..B] is offered whatever the shell does with patterns that match nothing. In its own
# shell, which failglob would end.
for option in failglob nullglob; do
    (
        shopt -s "$option"
        offers 'raytally render balls --' --level --slice --heatmap
        offers_only 'raytally render balls --lev' --level
        offers_only 'raytally bench balls --accel gr' grid
        offers_only 'raytally trace balls --rays sha' shadow
        [ $failures = 0 ]
    ) || failures=$((failures + 1))
done

[ $failures = 0 ]
