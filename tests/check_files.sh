#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_files.sh [TREE]: every .c file of the tree is built: CMakeLists.txt lists it, or for tests/DIRECTORY/test_NAME.c lists
# NAME in raytally_tests(DIRECTORY ...). Every source states its licence. CITATION.cff and CHANGELOG.md name the version of
# CMakeLists.txt. Files to which pages link exist. Prints the files that fail; exit code 1 if there is one.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

unlisted() {
    find src accel scenes tests -name '*.c' | sort | awk '
        FNR == NR {
            gsub(/[()]/, " & ")
            for (i = 1; i <= NF; i++) {
                if ($i == ")") tests = ""
                else if ($(i - 1) == "(" && $(i - 2) == "raytally_tests") tests = "tests/" $i "/test_"
                else listed[tests ? tests $i ".c" : $i]
            }
            next
        }
        !($0 in listed) { print $0 ": not in CMakeLists.txt" }' CMakeLists.txt -
}

unlicensed() {
    find . -name build -prune -o \( -name '*.[ch]' -o -name '*.sh' -o -name '*.gp' -o -name '*.py' -o -name '*.cmake' -o -name CMakeLists.txt \) -print |
        grep -v '^\./results/' | sort | xargs awk '
            FNR <= 2 && /SPDX-License-Identifier: Apache-2.0/ { states[FILENAME] }
            END { for (i = 1; i < ARGC; i++) if (!(ARGV[i] in states)) print ARGV[i] ": no SPDX line" }'
}

of_another_version() {
    local version
    version=$(sed -n 's/^project(raytally VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)
    grep -qx "version: $version" CITATION.cff || echo "CITATION.cff: the version is not $version"
    grep '^## ' CHANGELOG.md | grep -v -m 1 '(unreleased)$' | grep -q "^## $version " || echo "CHANGELOG.md: does not begin with version $version"
}

dead_links() { # check_slides.sh checks those of the slides
    local page link
    find . -name build -prune -o -name node_modules -prune -o -name slides.md -o -name '*.md' -print | sort | while read -r page; do
        { grep -oE '\]\([^)# ]+' "$page" || true; } | sed 's/^](//; /:/d' | sort -u | while read -r link; do
            [ -e "$(dirname "$page")/$link" ] || echo "$page: there is no $link"
        done
    done
}

failed=$(unlisted && unlicensed && of_another_version && dead_links)
[ -z "$failed" ] || { echo "$failed" && exit 1; }
