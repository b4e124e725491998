#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_counting_cost.sh [SCENE [KIND,... [SPEC...]]]: the cost of accelerators' kernels in instructions, which unlike times are
# the same on every run: per ray for the timed and the counted kernel, and for the timed one per ray
# before it is traced (set-up), per step, and per object test. Fails if counting makes a kernel need more than twice
# the instructions. Mailboxes and lists belong to tests, boxes to steps. Uses $RT_PROGRAM.
# For release builds with valgrind and addr2line; otherwise it is skipped (exit code 77).
set -euo pipefail
program=${RT_PROGRAM:-build/release/raytally}
scene=${1:-balls:size=3}
kinds=${2:-diffuse,occlusion}
specs=("${@:3}")
[ ${#specs[@]} -gt 0 ] || specs=(grid octree kd clusters bvh)

command -v valgrind >/dev/null && command -v addr2line >/dev/null || { echo "skipped: what counting costs in instructions; needs valgrind and binutils"; exit 77; }
grep -q '^CMAKE_BUILD_TYPE:[A-Z]*=Rel' "$(dirname "$program")/CMakeCache.txt" || { echo "skipped: what counting costs in instructions; needs a release build"; exit 77; }
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT

# member NAME: a number of the only row
member() {
    awk -v name="\"$1\":" '/"counts"/ || name == "\"rays\":" { on = 1 } on && $1 == name { print $2 + 0; exit }' "$work/json"
}

# costs KERNEL ACCELERATOR: prints address and instructions for each instruction of the kernel, calls added to their callers; and
# "calls N", how often it was entered. Other accelerators have kernels of the same name, in other files. callgrind's
# addresses are relative to those of the previous line.
costs() {
    awk -v kernel="$1'" -v file="/accel/$2[/.]" '
    function hex(text,   i, value) {
        for (i = 3; i <= length(text); i++) value = 16 * value + index("0123456789abcdef", substr(text, i, 1)) - 1
        return value
    }
    function number(line, names,   part) { # from "(number) name"; the name appears only the first time
        split(line, part, /[(] *|[)] */)
        if (part[3] != "") names[part[2]] = part[3]
        return part[2]
    }
    /^(fl|fi|fe|cfi|cfl)=/ { source = number($0, files); if (/^fl/) within = files[source] ~ file; next }
    /^fn=/ {
        id = number($0, names)
        inside = within && index(names[id], kernel) == 1 && names[id] ~ /pass_run/
        if (inside) own[id]
        next
    }
    /^cfn=/ { called = number($0, names); next }
    /^calls=/ { split($1, part, "="); calls[called] += part[2]; next }
    /^(0x|[-+*])/ {
        address = $1 ~ /^0x/ ? hex($1) : $1 == "*" ? address : address + $1
        if (inside) cost[address] += $3
    }
    END {
        for (address in cost) printf "%d %d\n", address, cost[address]
        for (id in own) sum += calls[id]
        print "calls", sum + 0
    }' "$work/callgrind"
}

# parts: from costs on stdin, the sums of "test", "setup" and "step", and the calls, by the place where code is inlined.
parts() {
    tee "$work/costs" | awk '$1 != "calls" { printf "%x\n", $1 }' >"$work/addresses"
    addr2line -a -f -i -e "$program" <"$work/addresses" | awk '
    /^0x/ { if (address != "") print address, part; address = $1; part = "step"; next }
    /^(rt_test_object|rt_test_list|rt_test_all)$/ { part = "test" }
    /^(rt_hit_ray|rt_mailbox_next_ray|start_axis|rt_line)$/ { part = "setup" }
    END { print address, part }' >"$work/parts"
    paste -d' ' "$work/parts" <(grep -v calls "$work/costs") |
        awk '{ sum[$2] += $4; all += $4 } END { printf "%d %d %d %d ", all, sum["test"], sum["setup"], sum["step"] }'
    awk '$1 == "calls" { print $2 }' "$work/costs"
}

failed=0
printf '%-10s %-24s %10s %8s %8s %9s %9s %11s\n' kind accelerator instr./ray set-up a\ step a\ test counted timed/count
for kind in ${kinds//,/ }; do
    case $kind in shadow | occlusion) question=occluded ;; *) question=nearest ;; esac
    for spec in "${specs[@]}"; do
        valgrind --tool=callgrind --dump-instr=yes --separate-callers2=nearest_timed --separate-callers2=nearest_counted \
            --separate-callers2=occluded_timed --separate-callers2=occluded_counted \
            --callgrind-out-file="$work/callgrind" "$program" bench "$scene" --accel "$spec" --rays "$kind" \
            --size 64x64 --limit 2048 --rounds 1 --threads 1 --json >"$work/json" 2>"$work/log" || {
            cat "$work/log"
            exit 1
        }
        read -r timed test setup step timed_calls <<<"$(costs "${question}_timed" "${spec%%:*}" | parts)"
        read -r counted _ _ _ counted_calls <<<"$(costs "${question}_counted" "${spec%%:*}" | parts)"
        row=$(awk -v timed="$timed" -v test="$test" -v setup="$setup" -v step="$step" -v counted="$counted" \
            -v passes="$timed_calls/$counted_calls" -v rays="$(member rays)" -v steps="$(member steps)" \
            -v tests="$(member object_tests)" 'BEGIN {
                split(passes, calls, "/")
                k = calls[1] / calls[2] # timed passes per counted one
                printf "%10.0f %8.0f %8.1f %9.1f %9.0f %11.2f", timed / k / rays, setup / k / rays, step / k / steps,
                    tests ? test / k / tests : 0, counted / rays, timed / k / counted
            }')
        printf '%-10s %-24s %s\n' "$kind" "$spec" "$row"
        [ "${row##* }" != nan ] && awk -v ratio="${row##* }" 'BEGIN { exit !(ratio >= 0.5) }' || {
            echo "  FAILED: counting takes more than it counts"
            failed=1
        }
    done
done
exit $failed
