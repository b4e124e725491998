#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# experiments/slurm.sh EXPERIMENT.yaml N [OPTION...]: runs an experiment on a Slurm cluster, as an array of N jobs, each with
# some of the scenes and its own node, and a job that joins their results into results/NAME. OPTIONs are those of
# `raytally run`, except --out, --shard and --resume. Run it at the top of the tree, on a file system that the nodes share.
#
# Submitted again, it continues jobs that were ended by hand, by a limit or by a kill. Prints the ids of the jobs.
#
#   RT_PROGRAM     the program (build/release/raytally)
#   OUT            the result directory (results/NAME); shards and the jobs' output go to $OUT-shards
#   SBATCH_OPTS    options of sbatch, as in "--partition=long --time=8:00:00"
set -euo pipefail

usage() { sed -n '3,/^set /s/^# \{0,1\}//p' "$0" | sed '/^set /d'; }
die() { echo "${0##*/}: $*" >&2 && exit 2; }

case "${1:-}" in -h | --help) usage && exit ;; esac
[ $# -ge 2 ] || { usage >&2 && exit 2; }
experiment=$1 shards=$2
shift 2
[[ $shards =~ ^[1-9][0-9]*$ ]] || die "'$shards' is not a number of jobs"
command -v sbatch >/dev/null || die "sbatch is missing: run this on a machine that submits to Slurm (Debian: slurm-client)"
program=$(realpath -- "${RT_PROGRAM:-build/release/raytally}") || die "build raytally first, or set RT_PROGRAM"
# The experiment is read before anything is submitted.
"$program" run "$experiment" --shard "$shards/$shards" --dry-run --force "$@" >/dev/null || exit 2
name=$(sed -n 's/^name: *//p' "$experiment" | tr -d "\"'" | sed 's/ *#.*//')
out=${OUT:-results/$name}
mkdir -p "$out-shards"
read -r -a options <<<"${SBATCH_OPTS:-}"

# submit OPTION... COMMAND: prints the job's id
submit() {
    sbatch --parsable --exclusive --requeue --open-mode=append "${@:1:$#-1}" "${options[@]}" --wrap "exec ${*: -1}"
}

run=$(printf '%q ' "$program" run "$experiment" "$@" --resume)
array=$(submit --job-name="raytally-$name" --array="1-$shards" --output="$out-shards/%a.log" \
    "$run --shard \$SLURM_ARRAY_TASK_ID/$shards --out $(printf %q "$out-shards")/\$SLURM_ARRAY_TASK_ID")
directories=()
for ((i = 1; i <= shards; i++)); do directories+=("$out-shards/$i"); done
join=$(submit --job-name="raytally-$name-merge" --dependency="afterok:$array" --output="$out-shards/merge.log" \
    "$(printf '%q ' "$program" merge "${directories[@]}" --trust --force -o "$out")")
echo "$array $join"
