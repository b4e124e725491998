#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_slurm.sh [--large]: experiments/slurm.sh on a cluster of one node, which it starts and ends: munged, slurmctld and
# slurmd on loopback, with their own files, keys and ports. 4 shards have the counts of one run; a killed job is continued
# when the experiment is submitted again. Needs root and Debian's slurm-wlm; skipped (77) without either, or if the
# daemons do not start. Uses $RT_PROGRAM.
#
# --large, by hand: also 10,112 cells in 8 shards, of which one is killed and continued; prints the seconds and sizes of the
# results and of what is made from them.
set -euo pipefail
cd "$(dirname "$0")/.."
program=$(realpath "${RT_PROGRAM:-build/release/raytally}")
skip() { echo "skipped: experiments/slurm.sh on a cluster of one node; needs $*" && exit 77; }
fail() { echo "$*" >&2 && tail -n 20 "$work"/*.log "$work"/*-shards/*.log >&2 2>/dev/null || true && exit 1; }

[ "$(id -u)" = 0 ] || skip "root, to start slurmctld and slurmd"
PATH=$PATH:/usr/sbin:/sbin
for daemon in munged slurmctld slurmd sbatch squeue; do
    command -v "$daemon" >/dev/null || skip "slurm-wlm (./test.sh --all installs it): there is no $daemon"
done

work=$(mktemp -d)
pids=()
end() {
    local pid
    for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
    for pid in "${pids[@]}"; do wait "$pid" 2>/dev/null || true; done
    rm -rf "$work"
}
trap end EXIT

# ---- the cluster ----

free_port() { # PORT: prints the first port from PORT on without a listener
    local port=$1
    while (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do port=$((port + 1)); done
    echo "$port"
}

controller=$(free_port $((20000 + RANDOM % 10000)))
node=$(free_port $((controller + 1)))
host=$(hostname -s)
mkdir -p "$work"/{state,spool,munge}
chmod 755 "$work" "$work/munge"
chmod 700 "$work/state"
head -c 1024 /dev/urandom >"$work/munge/key" && chmod 400 "$work/munge/key"
cat >"$work/slurm.conf" <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$controller
SlurmdPort=$node
SlurmUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$work/munge/socket
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,bf_interval=1,defer
MinJobAge=600
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=1 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF=$work/slurm.conf

begin() { # begin NAME COMMAND...: as a child of this script
    local name=$1
    shift
    "$@" >"$work/$name.log" 2>&1 &
    pids+=($!)
}

begin munged munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge/socket" --num-threads=2 \
    --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed"
for ((i = 0; i < 50; i++)); do [ -S "$work/munge/socket" ] && break || sleep 0.1; done
[ -S "$work/munge/socket" ] || skip "munged does not start: $(tail -n 1 "$work/munged.log")"
begin slurmctld slurmctld -D
begin slurmd slurmd -D -N "$host"
for ((i = 0; i < 100; i++)); do
    case "$(sinfo -h -o %T 2>/dev/null)" in idle*) break ;; esac
    sleep 0.2
done
case "$(sinfo -h -o %T 2>/dev/null)" in
idle*) ;;
*) skip "the node of the cluster does not come up: $(tail -n 1 "$work/slurmctld.log") $(tail -n 1 "$work/slurmd.log")" ;;
esac

# ---- an experiment ----

cat >"$work/sharded.yaml" <<'END'
name: sharded
question: On how many machines?
prediction: It does not matter.
scenes:
  - {scene: "balls:size=1|2", size: 16x16}
  - {scene: "random:n=50..400*2", size: 16x16}
accelerators:
  - {accel: bvh}
  - {accel: "grid:density=1..8*2"}
rays: [primary, shadow]
limit: 200
rounds: 3
milliseconds: 5
END

"$program" run "$work/sharded.yaml" --threads 1 --out "$work/one" >/dev/null 2>&1 || fail "the run on one machine failed"

submit() { OUT=$work/all RT_PROGRAM=$program experiments/slurm.sh "$work/sharded.yaml" 4 --threads 1; }

# wait_for FILE: until it exists, or no job is left
wait_for() {
    local i
    for ((i = 0; i < 600; i++)); do
        [ -e "$1" ] && return
        [ -n "$(squeue -h)" ] || { [ -e "$1" ] && return || return 1; }
        sleep 0.2
    done
    return 1
}

jobs=$(submit) || fail "slurm.sh failed"
wait_for "$work/all-shards/1/cells.jsonl" || fail "the first job does not measure"
scancel --signal=KILL --full "${jobs%% *}" && scancel $jobs
for ((i = 0; i < 100; i++)); do [ -z "$(squeue -h)" ] && break || sleep 0.2; done
[ -e "$work/all/manifest.json" ] && fail "what was killed is finished"

jobs=$(submit) || fail "slurm.sh failed when it was to go on"
wait_for "$work/all/report.html" || fail "the shards were not joined: $(squeue -a)"
cmp "$work/one/counts.csv" "$work/all/counts.csv" || fail "4 shards do not make the counts of one run"
grep -q "$host" "$work/all/times.csv" || fail "times.csv does not say where it was timed"
code=0
experiments/slurm.sh "$work/sharded.yaml" 99 2>"$work/refused.log" || code=$?
[ "$code" = 2 ] && grep -q 'too few for 99 shards' "$work/refused.log" || fail "99 shards of 6 scenes are not refused"

# ---- ten thousand cells ----

[ "${1:-}" = --large ] || exit 0
cat >"$work/large.yaml" <<'END'
name: large
question: Which of 79 accelerators is the cheapest on each of 32 scenes?
prediction: It differs.
scenes: [{scene: "random:n=20..51+1", size: 6x6}]
accelerators: [{accel: bvh}, {accel: "grid:density=1..78+1"}]
rays: [primary, shadow, diffuse, random]
limit: 40
rounds: 2
milliseconds: 0
END

submit() { OUT=$work/results/large RT_PROGRAM=$program experiments/slurm.sh "$work/large.yaml" 8 --threads 1; }
lines() { [ -e "$1" ] && wc -l <"$1" || echo 0; }
timed() { # timed NAME COMMAND...
    local name=$1 start=$EPOCHREALTIME
    shift
    "$@" >"$work/$name.log" 2>&1 || fail "$name failed"
    printf '%-10s %6.1f s\n' "$name" "$(bc -l <<<"$EPOCHREALTIME - $start")"
}
wait_for_jobs() { while [ -n "$(squeue -h -t PD,R,CG -n raytally-large)" ]; do sleep 0.5; done; }

run_all() {
    local killed kept jobs
    jobs=$(submit)
    killed=$work/results/large-shards/3/cells.jsonl
    while [ "$(lines "$killed")" -lt 500 ] && [ -n "$(squeue -h)" ]; do sleep 0.1; done
    scancel --signal=KILL --full "${jobs%% *}_3"
    wait_for_jobs
    kept=$(lines "$killed")
    [ -e "$work/results/large-shards/3/manifest.json" ] && return 1
    scancel $jobs
    submit >/dev/null
    wait_for "$work/results/large/report.html" || return 1
    echo "shard 3 had $kept lines when it was killed, and has $(lines "$killed")"
}
timed run run_all
cat "$work/run.log"
timed report "$program" report "$work/results/large"
timed index "$program" report --index "$work/results"
timed plot "$program" plot "$work/results/large"
timed compare "$program" compare "$work/results/large" "$work/results/large"
timed reproduce "$program" reproduce "$work/results/large"
cells=$(($(lines "$work/results/large/counts.csv") - 1))
(cd "$work/results/large" && wc -c cells.jsonl counts.csv times.csv report.html)
[ "$cells" = 10112 ] || fail "there are $cells cells"
[ "$(stat -c %s "$work/results/large/report.html")" -lt 12000000 ] || fail "the report of 10,112 cells is not under 12 MB"
