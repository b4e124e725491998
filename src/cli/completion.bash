# SPDX-License-Identifier: Apache-2.0
# Words are read into arrays, never left to the shell to part, which would also look for files that match them.

# _raytally_spec TABLE WORD: adds to found what NAME:KEY=VALUE,KEY=VALUE may go on with, TABLE being accels or scenes
_raytally_spec() {
    local table=$1 word=$2 before='' name key names
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
    read -ra names < <(_raytally_names "$table")
    found+=("${names[@]/#/"$before"}")
}

# _raytally_files WORD: adds to found the files whose paths begin so
_raytally_files() {
    local files
    mapfile -t files < <(compgen -f -- "$1")
    found+=("${files[@]}")
    if [ ${#files[@]} -gt 0 ]; then are_files=yes; fi
}

# _raytally_value COMMAND WHAT WORD: adds to found what a value may be that the table of options, or the usage, calls WHAT
_raytally_value() {
    local names before=''
    case $2 in
    SPEC*) _raytally_spec accels "$3" && found+=(all) ;;
    *SCENE* | 'IN OUT' | 'BEFORE AFTER') _raytally_spec scenes "$3" && _raytally_files "$3" ;;
    '[NAME]')
        read -ra names < <(_raytally_names "$1")
        found+=("${names[@]%+}")
        ;;
    KIND*)
        case $3 in *,*) before=${3%,*}, ;; esac
        read -ra names < <(_raytally_names kinds)
        found+=("${names[@]/#/"$before"}")
        ;;
    COUNTER*)
        read -ra names < <(_raytally_names counters)
        found+=("${names[@]}")
        ;;
    SHELL) found+=(bash) ;;
    [a-z]*\|*)
        IFS='|' read -ra names <<<"$2"
        found+=("${names[@]}")
        ;;
    FILE* | *DIR* | FOLDER | PROGRAM | EXPERIMENT*) _raytally_files "$3" ;;
    esac
}

# What the option $2 of the command $1 is followed by; nothing where that is no value.
_raytally_what() {
    local names each
    read -ra names < <(_raytally_names "options:$1")
    for each in "${names[@]}"; do
        case $2:$each in
        --*:"$2="*) echo "${each#*=}" && return ;;
        -?:"$2"?*) echo "${each#-?}" && return ;;
        esac
    done
}

_raytally() {
    local line=${COMP_LINE:0:COMP_POINT} words word command what='' option='' found=() names are_files='' each
    # Without -r a backslash keeps the blank behind it in its word, as in the shell.
    # shellcheck disable=SC2162
    read -a words <<<"$line"
    case $line in *'\ ') ;; *' ') words+=('') ;; esac
    word=${words[-1]} command=${words[1]}
    if [ ${#words[@]} -gt 2 ]; then what=$(_raytally_what "$command" "${words[-2]}"); fi
    case $word in --*=*) option=${word%%=*} what=$(_raytally_what "$command" "$option") option=$option= ;; esac
    if [ ${#words[@]} = 2 ] || [ "$command" = help ]; then
        read -ra names < <(_raytally_names commands)
        found=("${names[@]}" help --help --version)
    elif [ -n "$option$what" ]; then
        _raytally_value "$command" "$what" "${word#"$option"}"
    elif [[ $word = -* ]]; then
        read -ra names < <(_raytally_names "options:$command")
        for each in "${names[@]}"; do
            case $each in --*) found+=("${each%%=*}") ;; esac
        done
    else
        _raytally_value "$command" "$(_raytally_names "argument:$command")" "$word"
    fi
    # Behind : and = the shell sees a word of its own, and replaces no more than that.
    local current=${COMP_WORDS[COMP_CWORD]//\\/}
    case $current in [:=]*) current=${current#?} ;; esac
    local typed=${word%"$current"}
    COMPREPLY=()
    for each in "${found[@]}"; do
        each=$option$each
        case $each in "$word"*) COMPREPLY+=("${each#"$typed"}") ;; esac
    done
    if [ -n "$are_files" ]; then compopt -o filenames 2>/dev/null; fi
    case ${COMPREPLY[*]} in *[=+]) compopt -o nospace 2>/dev/null ;; esac
}
complete -F _raytally raytally
