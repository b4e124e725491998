# SPDX-License-Identifier: Apache-2.0
# `raytally completion --words` prints what may follow. Words are read into arrays: if the shell split them, it would also replace
# them by the names of matching files.
_raytally() {
    local line=${COMP_LINE:0:COMP_POINT} words word value found files
    # Without -r a backslash keeps the blank behind it in its word, as in the shell.
    # shellcheck disable=SC2162
    read -a words <<<"$line"
    case $line in *'\ ') ;; *' ') words+=('') ;; esac
    word=${words[-1]}
    mapfile -t found < <("${words[0]/#\~/$HOME}" completion --words "${words[@]:1}" 2>/dev/null)
    case ${found[*]} in
    *FILES)
        value=$word
        case $word in --*=*) value=${word#*=} ;; esac
        mapfile -t files < <(compgen -f -- "$value")
        unset 'found[-1]'
        found+=("${files[@]/#/"${word%"$value"}"}")
        if [ ${#files[@]} -gt 0 ]; then compopt -o filenames 2>/dev/null; fi
        ;;
    esac
    # Behind : and = the shell sees a word of its own, and replaces no more than that.
    local current=${COMP_WORDS[COMP_CWORD]//\\/}
    case $current in [:=]*) current=${current#?} ;; esac
    COMPREPLY=("${found[@]#"${word%"$current"}"}")
    case ${COMPREPLY[*]} in *[=+]) compopt -o nospace 2>/dev/null ;; esac
}
complete -F _raytally raytally
