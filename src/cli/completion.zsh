#compdef raytally
# SPDX-License-Identifier: Apache-2.0
# `raytally completion --words` prints what may follow.
_raytally() {
    local -a found
    local files
    found=("${(@f)$("${(Q)${~words[1]}}" completion --words "${(@Q)words[2,CURRENT]}" 2>/dev/null)}")
    if [[ $found[-1] == FILES ]]; then
        files=yes
        found[-1]=()
    fi
    compadd -S '' -- ${(M)found:#*[=+]}
    compadd -- ${found:#*[=+]}
    if [[ -n $files ]]; then
        compset -P '--*='
        _files
    fi
}
if [[ $funcstack[1] == _raytally ]]; then _raytally; else compdef _raytally raytally; fi
