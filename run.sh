#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh Debian 12 or 13 to a report: installs missing packages, builds only the program (no library, no tests), and runs
# the first experiment. Options go to `raytally run`: ./run.sh --quick, whose results are in results/first-look-quick. Run again,
# it resumes the experiment or shows its results; ./run.sh --force measures again.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_missing build optional data
fetch_bunny
targets=raytally build release -DRT_KERNELS=native
say "running experiments/first-look.yaml"
out=()
[[ " $* " != *" --quick "* ]] || out=(--out results/first-look-quick)
exec build/release/raytally run experiments/first-look.yaml "${out[@]}" --resume "$@"
