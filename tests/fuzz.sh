#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# tests/fuzz.sh [--seconds N] [TARGET...]: fuzzes raytally's readers and accelerators (tests/fuzz/). For each target, or for
# those that are named, libFuzzer makes inputs for N seconds (60) out of files of the repository and of the inputs that earlier
# runs kept in corpus/TARGET of the build. Prints a line for each target, and the end of what libFuzzer says of an input that
# fails; that is kept in found/TARGET-..., and the exit code is 1. $RT_FUZZER replaces the executable of the preset `fuzz`,
# $RT_SEED the seed of the random numbers, which is another each time.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
shopt -s nullglob globstar
seconds=60
[ "${1-}" != --seconds ] || { seconds=${2:?tests/fuzz.sh: --seconds needs a number} && shift 2; }
if [ -z "${RT_FUZZER-}" ]; then
    cmake --preset fuzz -DRT_KERNELS=native >/dev/null
    cmake --build --preset fuzz --target raytally_fuzz
    RT_FUZZER=build/fuzz/raytally_fuzz
fi
build=$(dirname "$(realpath "$RT_FUZZER")")
mkdir -p "$build/found"
mapfile -t targets < <("$RT_FUZZER")
[ $# = 0 ] || targets=("$@")

# seeds TARGET: the files to begin with
seeds() {
    printf '%s\n' tests/fuzz/corpus/"$1"/*
    case $1 in
    yaml) printf '%s\n' scenes/*.yaml experiments/light-buffer/*.yaml tests/golden/**/*.yaml ;;
    nff) printf '%s\n' scenes/*.nff ;;
    experiment) printf '%s\n' experiments/*.yaml experiments/{lecture,papers}/*.yaml ;;
    manifest) printf '%s\n' results/reference/*/manifest.json ;;
    packed-journal) printf '%s\n' results/reference/{bittner-2013,width}/*.gz ;;
    csv) printf '%s\n' results/reference/*/verify.csv experiments/published/*.csv ;;
    esac
}

# Words of all formats are those of the source.
grep -ohE '"[a-zA-Z0-9_.:-]{2,24}"' -r src accel scenes --include='*.[ch]' | sort -u >"$build/found/words"
failed=0
printf '%-16s %8s %12s %10s  %s\n' target seconds executions branches result
for target in "${targets[@]}"; do
    log=$build/found/$target.log corpus=$build/corpus/$target result=good start=$SECONDS
    mkdir -p "$corpus"
    seeds "$target" | grep . | paste -sd, >"$build/found/$target.seeds" || true
    RT_FUZZ_TARGET=$target "$RT_FUZZER" -seed="${RT_SEED-0}" -max_total_time="$seconds" -timeout=30 -rss_limit_mb=3000 \
        -print_final_stats=1 -dict="$build/found/words" -seed_inputs="@$build/found/$target.seeds" \
        -artifact_prefix="$build/found/$target-" "$corpus" >"$log" 2>&1 || result=FAILED
    executed=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    reached=$(sed -n 's/^#.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n 1)
    printf '%-16s %8s %12s %10s  %s\n' "$target" $((SECONDS - start)) "${executed:--}" "${reached:--}" "$result"
    [ "$result" = good ] || { failed=1 && tail -n 40 "$log"; }
done
exit $failed
