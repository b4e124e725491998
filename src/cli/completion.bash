# SPDX-License-Identifier: Apache-2.0
# Completion in bash: commands, options, accelerators and built-in scenes, from what raytally prints of them; else files.
_raytally() {
    local program=${COMP_WORDS[0]/#\~/$HOME} word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} names=''
    # In --accel=bvh the shell sees three words.
    if [ "$word" = = ]; then word=''; elif [ "$before" = = ]; then before=${COMP_WORDS[COMP_CWORD - 2]}; fi
    if [ "$COMP_CWORD" = 1 ]; then
        names=$("$program" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z-]*\) .*/\1/p')
    else
        case $word:$before in
        -*) names=$("$program" "${COMP_WORDS[1]}" --help | grep -oE '^(  -., |      )--[a-z-]+' | grep -o -e '--.*') ;;
        *:--accel | *:-a | *:--baseline | *:accels) names="all $("$program" accels | sed -n 's/^\([a-z_]*\): .*/\1/p')" ;;
        *:-*) ;;
        *) names=$("$program" scenes | sed -n 's/^\([a-z_]*\): .*/\1/p') ;;
        esac
    fi 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -W "$names" -- "$word")
}
complete -o default -F _raytally raytally
