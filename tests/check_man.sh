#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_man.sh: cmake/man_pages.sh makes a manual page for raytally and one for each command, with its options, and neither man
# nor mandoc (if available) reports a problem. Uses $RT_PROGRAM. Skipped (77) without help2man.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$(dirname "$0")/.."
command -v help2man >/dev/null || { echo 'skipped: manual pages; needs help2man' && exit 77; }

mkdir "$work/bin" && ln -s "$program" "$work/bin/raytally"
cmake/man_pages.sh "$work/bin/raytally" "$work/man"
for command in '' $("$program" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z-]*\) .*/\1/p'); do
    name=raytally${command:+-$command} page=$work/man/raytally${command:+-$command}.1
    [ -s "$page" ] || { complain "there is no page $name" && continue; }
    grep -qF -e "${name//-/\\-} \\- " "$page" || complain "$name: the NAME is another one"
    if command -v man >/dev/null; then
        faults=$(LC_ALL=C.UTF-8 man --warnings -E UTF-8 -l "$page" 2>&1 >"$work/text")
        [ -z "$faults" ] || complain "$name: man says: $faults"
        for option in $([ -z "$command" ] || "$program" "$command" --help | grep -oE '^ {2,6}(-., )?--[a-z-]+' | grep -o -e '--.*'); do
            grep -q -e "$option" "$work/text" || complain "$name: lacks $option"
        done
    fi
    if command -v mandoc >/dev/null; then
        faults=$(mandoc -Tlint -Wwarning "$page" | sed "s|$work/man/||") || true
        [ -z "$faults" ] || complain "$name: mandoc says: $faults"
    fi
done
conclude
