#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The timed kernels hold no counting code. Counters are 64-bit words in memory, and counting adds to them; so
# no function of the library called ..._timed may add to a 64-bit word in memory, except on its own
# stack (which SIMD code addresses by %rbp). Nor may it call one called ..._counted, which counts as an addition.
# The functions called ..._counted must: the counted kernels of each file show that this script would detect it. Nor may a
# timed kernel test for an observer (core/base/observe.h): it may not name rt_trace_observer, as counted kernels do. A file
# without timed kernels must count nothing.
# For optimised x86-64 builds; otherwise it is skipped (exit code 77).
set -eu

build=$(dirname "${RT_PROGRAM:-$(dirname "$0")/../build/release/raytally}")
library=$build/libraytally_accel.a
[ "$(uname -m)" = x86_64 ] || { echo "skipped: timed kernels count nothing; needs x86-64"; exit 77; }
command -v objdump >/dev/null || { echo "skipped: timed kernels count nothing; needs binutils"; exit 77; }
grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=Rel' "$build/CMakeCache.txt" || { echo "skipped: timed kernels count nothing; needs a release build"; exit 77; }

objdump --disassemble --reloc --no-show-raw-insn "$library" | awk '
/file format/ { file = $1; sub(/:$/, "", file); file = ++members " " file }  # names repeat: wide and item have a kernels_avx2.c
/^[0-9a-f]+ <.*>:$/ {
    kind = $2 ~ /_timed/ ? "timed" : $2 ~ /_counted/ ? "counted" : ""
    if (kind == "") next
    name = $2; gsub(/[<>:]/, "", name)
    seen[file, kind]++
    framed = 0
    if (!(file in known)) { known[file] = 1; files[++n] = file }
    next
}
kind == "" { next }
/R_X86_64_.*rt_(trace_observer|observe)/ {
    looks[file, kind]++
    if (kind == "timed") print "  " file ": " name ": " $0
}
/R_X86_64_.*_counted/ {
    adds[file, kind]++
    if (kind == "timed") print "  " file ": " name ": " $0
}
/[ \t]mov[ \t]+%rsp,%rbp/ { framed = 1 }
# addq $1,8(%rdi)   incq (%rax)   lock addq ...   add %rax,8(%rdi)   -- but not n(%rsp), nor -n(%rbp) if %rbp is the
# frame: spilled registers
/[ \t](addq|subq|incq|decq|adcq)[ \t].*\(/ || /[ \t](add|sub|adc|xadd)[ \t]+%r[a-z0-9]+,[^%]*\(/ {
    if ($0 ~ /\(%rsp[,)]/ || (framed && $0 ~ /-0x[0-9a-f]+\(%rbp\)/)) next
    if ($0 ~ /%r[0-9]+[dwb],/) next
    adds[file, kind]++
    if (kind == "timed") print "  " file ": " name ": " $0
}
END {
    for (i = 1; i <= n; i++) {
        f = files[i]
        printf "%-24s timed kernels: %d, additions to memory: %d; counted: %d, additions: %d\n", f,
            seen[f, "timed"], adds[f, "timed"], seen[f, "counted"], adds[f, "counted"]
        if (looks[f, "timed"] > 0) { print "  FAILED: a timed kernel looks for an observer"; bad = 1 }
        if (looks[f, "counted"] > 0) observers++
        if (adds[f, "timed"] > 0) { print "  FAILED: a timed kernel counts"; bad = 1 }
        if (seen[f, "timed"] == 0 && adds[f, "counted"] > 0) { print "  FAILED: it counts, and has no timed kernel"; bad = 1 }
        if (f ~ / (host|remote)\.c\.o$/) continue # the kernels of plugins count
        if (seen[f, "timed"] > 0 && (seen[f, "counted"] == 0 || adds[f, "counted"] == 0)) {
            print "  FAILED: nothing to compare with: the counted kernels show no counting"; bad = 1
        }
    }
    print observers + 0 " files have counted kernels that look for an observer"
    if (observers == 0) { print "FAILED: no counted kernel is seen to look for an observer: this script would not see a timed one"; bad = 1 }
    if (n == 0) { print "FAILED: there are no kernels"; bad = 1 }
    exit bad
}'
