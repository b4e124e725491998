#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_format.sh: every C file is formatted as .clang-format says. Other versions format differently:
# without clang-format 14 the check is skipped (77).
set -euo pipefail
cd "$(dirname "$0")/.."

tool=$(command -v clang-format-14 || command -v clang-format) || { echo "skipped: the layout of C files; needs clang-format 14" && exit 77; }
"$tool" --version | grep -q 'version 14\.' || { echo "skipped: the layout of C files; needs clang-format 14, as on Debian 12" && exit 77; }
find src accel examples experiments include scenes tests -name '*.[ch]' -print0 | xargs -0 "$tool" --dry-run --Werror
