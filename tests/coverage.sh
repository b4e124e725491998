#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# coverage.sh [CTEST OPTION...]: how many lines and branches of the program the tests execute, by directory and in total, and
# the files with the fewest. Builds build/coverage, and runs all tests but the slow ones, or those that ctest's options choose;
# with `none` it only counts what earlier tests left. Needs gcovr (Debian). Assertions are compiled out. What a process does that
# ends by a signal or in a plugin's fork is not counted.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v gcovr >/dev/null || { echo "coverage.sh: there is no gcovr: apt-get install gcovr" >&2 && exit 2; }
build=build/coverage
jobs=${JOBS:-$(nproc)}

if [ "${1-}" != none ]; then
    [ $# -gt 0 ] || set -- -LE 'slow|tree'
    cmake --preset coverage -DRT_KERNELS=native >/dev/null
    cmake --build --preset coverage -j "$jobs" | tail -n 1
    find "$build" -name '*.gcda' -delete
    ctest --test-dir "$build" -j "$jobs" --timeout 1800 "$@" | tail -n 20 || true
fi

# Branches that gcc adds for inlined code that cannot be reached are no branches of ours.
gcovr --root . --object-directory "$build" --exclude-directories '.*CompilerIdC' --exclude-unreachable-branches --filter 'src/' --filter 'accel/' --filter 'scenes/' \
    -j "$jobs" --json-summary "$build/coverage.json" >/dev/null
python3 - "$build/coverage.json" <<'END'
import collections, json, sys
files = json.load(open(sys.argv[1]))["files"]
sums = collections.defaultdict(lambda: [0, 0, 0, 0])
for file in files:
    counts = [file[key] for key in ("line_covered", "line_total", "branch_covered", "branch_total")]
    folder = file["filename"].rsplit("/", 1)[0]
    for name in (folder, "in total"):
        sums[name] = [a + b for a, b in zip(sums[name], counts)]
def row(name, c):
    print("%-28s %6.1f %% of %6d lines %6.1f %% of %6d branches" %
          (name, 100 * c[0] / max(c[1], 1), c[1], 100 * c[2] / max(c[3], 1), c[3]))
for name in sorted(sums, key=lambda n: (n == "in total", n)):
    row(name, sums[name])
print("\nThe most lines that no test executes:")
for f in sorted(files, key=lambda f: f["line_covered"] - f["line_total"])[:25]:
    row(f["filename"], [f[k] for k in ("line_covered", "line_total", "branch_covered", "branch_total")])
END
