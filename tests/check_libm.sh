#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_libm.sh [TREE]: the program calls no function of the mathematical library whose last bits differ between
# libraries; src/core/base/elementary.h has replacements. Prints each call; exit code 1 if there is one.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

inexact='a?(sin|cos|tan)(h|pi)?|atan2|sincos|exp(2|10|m1)?|log(2|10|1p)?|pow|cbrt|hypot|[lt]gamma|erfc?|fma'
calls=$(find src accel scenes -name '*.[ch]' -print0 | sort -z | xargs -0 grep -nHE "\b($inexact)[fl]?\(" |
    grep -vE '^[^:]*:[0-9]*: *(/?\*|//)' || true)
[ -z "$calls" ] || { echo "$calls" && exit 1; }
