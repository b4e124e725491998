#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh Debian 12 or 13 to a report: installs what is missing, builds the program alone (no library, no tests), runs
# the first experiment.
# Options go to `raytally run`: ./run.sh --quick. A second time it goes on where the first one stopped, or shows what
# it found: ./run.sh --force measures anew.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_missing build optional data
fetch_bunny
targets=raytally build release -DRT_KERNELS=native
say "running experiments/first-look.yaml"
exec build/release/raytally run experiments/first-look.yaml --resume "$@"
