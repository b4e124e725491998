# SPDX-License-Identifier: Apache-2.0
# testing.sh, which test scripts source: $program is raytally, $RT_PROGRAM as an absolute path; $work a scratch directory,
# removed at the end. `complain` reports a failure, and the script goes on; it ends with `conclude`.
program=$(realpath "${RT_PROGRAM:-$(dirname "${BASH_SOURCE[0]}")/../build/release/raytally}")
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
failures=0
unset COLUMNS # tables would be printed in parts

complain() {
    printf '%s\n' "$*" >&2
    failures=$((failures + 1))
}

# conclude: exit code 1 if there was a complaint
conclude() {
    [ "$failures" = 0 ] || { echo "$failures complaints" >&2 && exit 1; }
}

# python_with_numpy: the path of a python3 that has NumPy; another one may come first in PATH
python_with_numpy() {
    local candidate
    for candidate in python3 /usr/bin/python3; do
        if "$candidate" -c 'import numpy' 2>/dev/null; then command -v "$candidate" && return; fi
    done
    return 1
}

# ends CODE ARGUMENT...: runs raytally, and checks its exit code; stdout goes to the file `printed`, stderr to `said`
ends() {
    local wanted=$1 code=0
    shift
    last=$*
    timeout 120 "$program" "$@" >printed 2>said </dev/null || code=$?
    [ "$code" = "$wanted" ] || complain "raytally $last: exit code $code, not $wanted: $(cat said)"
}

# says PATTERN, says_not PATTERN: an extended regular expression, in what it wrote, on one line
says() {
    [[ $(cat printed said | tr '\n' ' ') =~ $1 ]] || complain "raytally $last: does not say '$1': $(tail -n 50 said printed)"
}
says_not() {
    [[ ! $(cat printed said | tr '\n' ' ') =~ $1 ]] || complain "raytally $last: says '$1': $(tail -n 50 said printed)"
}

# verified_scenes [families]: those that `verify` takes by default, or its families, a line each
verified_scenes() {
    "$program" verify "$@" --accel brute --rays 1 --json | sed -n 's/^ *"scene": "\(.*\)",/\1/p'
}

# check_links DOCUMENT: the files that it links to exist
check_links() {
    local link
    while read -r link; do
        [ -e "$(dirname "$1")/$link" ] || complain "$1: there is no $link"
    done < <(grep -oE '\]\([^)# ]+' "$1" | sed 's/^](//; /:/d' | sort -u)
}
