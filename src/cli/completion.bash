# SPDX-License-Identifier: Apache-2.0
# _raytally_spec TABLE WORD: what NAME:KEY=VALUE,KEY=VALUE may go on with, TABLE being accels or scenes
_raytally_spec() {
    local table=$1 word=$2 before='' name key each
    case $table:$word in
    accels:*+*) before=${word%+*}+ word=${word##*+} ;;
    esac
    name=${word%%:*} key=${word##*[:,]}
    case $word in
    *:*=*)
        case $key in
        *=*) before=$before${word%"${key#*=}"} table=$table:$name:${key%%=*} ;;
        *) before=$before${word%"$key"} table=$table:$name ;;
        esac
        ;;
    *:*) before=$before$name: table=$table:$name ;;
    esac
    for each in $(_raytally_names "$table"); do echo "$before$each"; done
}

# _raytally_value COMMAND WHAT WORD: what a value may be that the table of options, or the usage, calls WHAT
_raytally_value() {
    local each
    case $2 in
    SPEC*) _raytally_spec accels "$3" && echo all ;;
    *SCENE* | 'IN OUT' | 'BEFORE AFTER') _raytally_spec scenes "$3" && compgen -f -- "$3" ;;
    '[NAME]') _raytally_names "$1" | tr -d + ;;
    KIND*)
        for each in $(_raytally_names kinds); do
            case $3 in
            *,*) echo "${3%,*},$each" ;;
            *) echo "$each" ;;
            esac
        done
        ;;
    COUNTER*) _raytally_names counters ;;
    SHELL) echo bash ;;
    [a-z]*\|*) tr '|' ' ' <<<"$2" ;;
    FILE* | *DIR* | FOLDER | PROGRAM | EXPERIMENT*) compgen -f -- "$3" ;;
    esac
}

# What the option $2 of the command $1 is followed by; nothing where that is no value.
_raytally_what() {
    local each
    for each in $(_raytally_names "options:$1"); do
        case $2:$each in
        --*:"$2="*) echo "${each#*=}" && return ;;
        -?:"$2"?*) echo "${each#-?}" && return ;;
        esac
    done
}

_raytally() {
    local line=${COMP_LINE:0:COMP_POINT} words word command what='' option='' found each
    read -ra words <<<"$line"
    case $line in *' ') words+=('') ;; esac
    word=${words[-1]} command=${words[1]}
    if [ ${#words[@]} -gt 2 ]; then what=$(_raytally_what "$command" "${words[-2]}"); fi
    case $word in --*=*) option=${word%%=*} what=$(_raytally_what "$command" "$option") option=$option= ;; esac
    if [ ${#words[@]} = 2 ] || [ "$command" = help ]; then
        found="$(_raytally_names commands) help --help --version"
    elif [ -n "$option$what" ]; then
        found=$(_raytally_value "$command" "$what" "${word#"$option"}")
    elif [[ $word = -* ]]; then
        found=$(_raytally_names "options:$command" | tr ' ' '\n' | sed -n 's/^\(--[^=]*\).*/\1/p')
    else
        found=$(_raytally_value "$command" "$(_raytally_names "argument:$command")" "$word")
    fi
    # Behind : and = the shell sees a word of its own, and replaces no more than that.
    local current=${COMP_WORDS[COMP_CWORD]}
    case $current in [:=]*) current=${current#?} ;; esac
    local typed=${word%"$current"}
    COMPREPLY=()
    for each in $found; do
        each=$option$each
        case $each in "$word"*) COMPREPLY+=("${each#"$typed"}") ;; esac
    done
    case ${COMPREPLY[*]} in *[=+]) compopt -o nospace 2>/dev/null ;; esac
}
complete -F _raytally raytally
