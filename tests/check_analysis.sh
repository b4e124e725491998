#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_analysis.sh [WORD]: by hand; it takes four minutes of a processor. gcc's analyzer (-fanalyzer) and cppcheck report nothing on the
# program's files, or on those whose path contains WORD, except false reports, which are listed below with the reason. A listed
# report that neither tool makes any more is a failure too. Reads the compile_commands.json beside $RT_PROGRAM, of a build by gcc,
# with assertions, which inform both tools. Kernels are examined for one instruction set, and status.c not at all, as in
# check_tidy.sh, which runs clang's analyzer. What gcc says in full is written to analysis.log there.
# Skipped (77) without gcc 12 and cppcheck 2.10, those of Debian 12: other versions have other false reports.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath "$(dirname "${RT_PROGRAM:-build/release/raytally}")")
word=${1-}
jobs=${JOBS:-$(nproc)}
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
skip() { echo "skipped: gcc's analyzer and cppcheck report nothing; needs $1" && exit 77; }
cppcheck --version 2>/dev/null | grep -q ' 2\.10' || skip "cppcheck 2.10, as on Debian 12"
compiler=$(sed -n 's/^CMAKE_C_COMPILER:[A-Z]*=//p' "$build/CMakeCache.txt" 2>/dev/null) || compiler=false
[[ $("$compiler" --version 2>/dev/null) == *"(Debian 12."* ]] || skip "a build by gcc 12, as on Debian 12"

# Not asked for: values that are not initialised. Both tools believe that a loop over 0, 1, 2 may end before it begins, and
# cppcheck does not know vectors. Warnings of gcc and clang look for such values too, and valgrind (check_valgrind.sh) where tests run.
gcc_options='-UNDEBUG -O2 -Wno-error -fanalyzer -Wno-analyzer-use-of-uninitialized-value -fdiagnostics-plain-output'
cppcheck_options=(--enable=warning,performance,portability --suppress={uninitvar,legacyUninitvar,ctuuninitvar})
# Each tool sees one file at a time: with this, status.h and yaml.h tell it, as they tell clang, that a failure is never RT_OK.
define=-D__clang_analyzer__

# False reports: file, kind, a part of the line, reason.
accepted() {
    sed 's/  \+/\t/g' <<'END'
src/core/base/file.c       analyzer-malloc-leak              fdopen(descriptor                 the caller has it, in *output
src/core/base/process.c    analyzer-malloc-leak              *command->from = fdopen           the caller has both streams, in *command->to and *command->from
accel/tree/spatial.c       identicalConditionAfterEarlyExit  counts[0] == 0 || counts[1] == 0  cut_at has changed the counts since they were compared with 0
accel/wide/wide_kernels.c  nullPointerRedundantCheck         f->tally->steps++                 counted kernels have a tally; RT_OBSERVED asks because timed ones have none
src/core/base/param.c      incorrectLogicOperator            -0x1p63                           cppcheck takes numbers with a binary exponent for 0
END
}

commands() {
    sed -n 's/^ *"command": "\(.*\)",$/\1/p' "$build/compile_commands.json" | sed 's/\\"/"/g; s/\\\\/\\/g' |
        awk -v word="$word" '$NF !~ /\/tests\/|\/base\/status\.c$/ && index($NF, word) && !seen[$NF]++'
}

# analyze COMMAND: that of a compilation
analyze() {
    local flags=${1%% -o *} source=${1##* -c }
    cd "$build" && eval "${flags#*ccache } $gcc_options $define -c $source -o /dev/null" 2>&1 || true
}
export -f analyze
export build gcc_options define

commands >"$work/commands"
tr '\n' '\0' <"$work/commands" | xargs -0 -P "$jobs" -I '{}' bash -c 'analyze "$1"' - '{}' >"$build/analysis.log"
awk '{ print $NF }' "$work/commands" >"$work/files"
cppcheck -q -j "$jobs" --std=c11 --language=c "${cppcheck_options[@]}" --template='{file}:{line}:{column}: {severity}: {message} [{id}]' \
    --file-list="$work/files" -D_GNU_SOURCE -DRT_VERSION='""' $define -I src -I include -I . >"$work/cppcheck" 2>&1

grep -E '\[-Wanalyzer-[a-z-]+\]$|error: ' "$build/analysis.log" | cat - "$work/cppcheck" | sed "s|^$PWD/||" | sort -u >"$work/found" || true
accepted | awk -F '\t' -v all="${word:+no}" '
    FNR == NR { kept[++count] = $0; next }
    {
        split($0, place, ":")
        kind = $0
        sub(/.*\[(-W)?/, "", kind) && sub(/\]$/, "", kind)
        for (line = 0; line < place[2] && (getline text <place[1]) > 0; line++);
        close(place[1])
        for (i = 1; i <= count; i++) {
            split(kept[i], row, "\t")
            if (row[1] == place[1] && row[2] == kind && index(text, row[3])) break
        }
        if (i <= count) made[i]
        else { print; failed = 1 }
    }
    END {
        for (i = 1; i <= count && all == ""; i++) if (!(i in made)) { print "no longer reported: " kept[i]; failed = 1 }
        exit failed
    }' - "$work/found"
