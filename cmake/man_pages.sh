#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# man_pages.sh PROGRAM DIR: writes manual pages of raytally and each of its commands to DIR, by help2man (Debian), from
# --help, which argp makes from the tables of options. SOURCE_DATE_EPOCH, if set, is their date.
set -euo pipefail
program=$1 folder=$2
mkdir -p "$folder"
read -r version < <("$program" --version)
date=$(date -u -d "@${SOURCE_DATE_EPOCH:-$(date +%s)}" +%F)

# page NAME SUMMARY PROGRAM...: NAME.1
page() {
    help2man --no-info --section=1 --source="$version" --manual=raytally --version-string="${version##* }" --name="$2" "${*:3}" |
        sed -E "s/^\.TH [^\"1]+\"?1\"? \"[^\"]*\"/.TH ${1^^} 1 $date/; s/^raytally [a-z\\-]+ \\\\- /${1//-/\\\\-} \\\\- /" >"$folder/$1.1"
}

page raytally "compare ray-tracing acceleration structures" "$program"
"$program" --help | sed -nE '/^Commands:/,/^$/s/^  ([a-z-]+) +(\[?[A-Z][]A-Z. ]*)  +(.*)/\1 \3/p' |
    while read -r command summary; do page "raytally-$command" "$summary" "$program $command"; done
