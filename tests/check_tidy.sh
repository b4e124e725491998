#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_tidy.sh [--deep]: clang-tidy reports nothing, with the checks of .clang-tidy, except on tests (it does not understand
# their assertions) and status.c (status.h explains why). Reads the compile_commands.json beside
# $RT_PROGRAM, with assertions enabled, which inform it. It examines a tenth of the tool's default number of states per
# function, which takes a third of the time, and kernels for the widest instruction set alone; --deep: all of them. Skipped (77)
# without clang-tidy 14.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(dirname "${RT_PROGRAM:-build/release/raytally}")

tool=$(command -v clang-tidy-14 || command -v clang-tidy) || { echo "skipped: clang-tidy finds nothing; needs clang-tidy 14" && exit 77; }
"$tool" --version | grep -q 'version 14\.' || { echo "skipped: clang-tidy finds nothing; needs clang-tidy 14, as on Debian 12" && exit 77; }
commands=$(mktemp -d) && trap 'rm -rf "$commands"' EXIT
if [ "${1-}" = --deep ]; then
    cp "$build/compile_commands.json" "$commands"
else # a file's last command
    awk '/^{/ { entry = "" } { entry = entry "\n" $0 } /^  "file": / { file = $0 } /^}/ { sub(/,$/, "", entry); last[file] = entry }
        END { for (file in last) { printf "%s%s", separator ? separator : "[", last[file]; separator = "," } print "\n]" }' \
        "$build/compile_commands.json" >"$commands/compile_commands.json"
fi
options=(-p "$commands" --quiet --extra-arg=-UNDEBUG --extra-arg=-Wno-ignored-optimization-argument
    --extra-arg=-Wno-unused-command-line-argument)
[ "${1-}" = --deep ] || for option in -Xclang -analyzer-config -Xclang max-nodes=22500; do
    options+=("--extra-arg=$option")
done
files=$(grep -o '"file": "[^"]*"' "$build/compile_commands.json" | cut -d '"' -f 4 | grep -v -e /tests/ -e /base/status.c | sort -u)
# In its second file clang-tidy 14 takes every va_list for uninitialised: those have a process each.
status=0
xargs grep -l va_list <<<"$files" | xargs -P "$(nproc)" -n 1 "$tool" "${options[@]}" 2>/dev/null || status=1
xargs grep -L va_list <<<"$files" | xargs -P "$(nproc)" -n 5 "$tool" "${options[@]}" 2>/dev/null || status=1
exit $status
