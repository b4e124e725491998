#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Sourced by tests/faults.sh and tests/mutate.py, which change copies of the tree $here.

# Files that differ are copied with a new date, so their dependents are rebuilt.
copy_tree() { # COPY
    (cd "$here" && find . \( -path ./build -o -name .git -o -path ./results -o -path ./scenes/fetched \) -prune -o -type f -print) |
        while read -r path; do
            cmp -s "$here/$path" "$1/$path" || { mkdir -p "$(dirname "$1/$path")" && cp "$here/$path" "$1/$path"; }
        done
}

configure() { # COPY
    local launcher=()
    if command -v ccache >/dev/null; then launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache); fi
    cmake -S "$1" -B "$1/build" -G Ninja -DRT_KERNELS=native -DRT_DEBUG_INFO=-g0 -DCMAKE_BUILD_TYPE=Release "-DCMAKE_C_FLAGS_RELEASE=-O1 -DNDEBUG" "${launcher[@]}"
}
