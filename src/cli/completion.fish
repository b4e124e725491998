# SPDX-License-Identifier: Apache-2.0
# `raytally completion --words` prints what may follow.
function __raytally_words
    set -l words (commandline -opc) (commandline -ct | string unescape)
    set -l found ($words[1] completion --words $words[2..-1] 2>/dev/null)
    if test "$found[-1]" = FILES
        set -e found[-1]
        set -l option (string match -r -- '^--[^=]*=' $words[-1])
        string replace -r -- '^' "$option" (__fish_complete_path (string replace -r -- '^--[^=]*=' '' $words[-1]))
    end
    string join \n -- $found
end
complete -c raytally -f -a '(__raytally_words)'
