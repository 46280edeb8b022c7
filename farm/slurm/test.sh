#!/usr/bin/env bash
# Runs farm/slurm for real: munged, slurmctld and slurmd of Debian's packages, in a folder of their own, as root.
# FOGBOW is the program (default: the release build). Takes about two minutes. Exit code 77: not run.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source-path=SCRIPTDIR source=../testing.sh
. "$here/../testing.sh"

[ "$(id -u)" = 0 ] || not_run "Slurm is started as root"
if ! has slurmctld slurmd sbatch munged; then
    has apt-get || not_run "it needs slurmctld, slurmd and munge"
    step "install Slurm"
    { apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends slurm-wlm munge; } \
        >/dev/null 2>&1 || not_run "slurm-wlm and munge cannot be installed"
fi

work=$(mktemp -d)
chmod 755 "$work"
cleanup() {
    local pid
    for pid in slurmd.pid slurmctld.pid munge/pid; do
        [ ! -e "$work/$pid" ] || kill "$(cat "$work/$pid")" 2>/dev/null || true
    done
    sleep 1
    rm -rf "$work"
}
trap cleanup EXIT

step "start a cluster of one node"
node=$(hostname -s)
mkdir -p "$work"/{state,spool,munge}
head -c 1024 /dev/urandom >"$work/munge/key"
chmod 700 "$work/munge"
chmod 400 "$work/munge/key"
chown -R munge: "$work/munge"
# Two partitions: tasks in low have 60 s to end when a job comes into high. A credential that expires soon lets tasks
# that are requeued start again at once.
cat >"$work/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket,cred_expire=5
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=2
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldPort=17817
SlurmdPort=17818
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
SlurmdParameters=config_overrides
JobRequeue=1
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
NodeName=$node NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=low Nodes=$node Default=YES PriorityTier=1 GraceTime=60
PartitionName=high Nodes=$node PriorityTier=10 PreemptMode=OFF
CONF
export SLURM_CONF=$work/slurm.conf
runuser -u munge -- munged --key-file="$work/munge/key" --socket="$work/munge/socket" --pid-file="$work/munge/pid" \
    --log-file="$work/munge/log" --seed-file="$work/munge/seed" --force 2>/dev/null
slurmctld -i -c
slurmd -N "$node"
for _ in $(seq 100); do
    [ "$(sinfo -h -o %t 2>/dev/null | sort -u)" = idle ] && break
    sleep 0.2
done
sinfo
cd "$work"

# Waits until command $2... succeeds, $1 seconds at most.
await() {
    local seconds=$1
    shift
    for _ in $(seq $((seconds * 5))); do
        if "$@"; then return; fi
        sleep 0.2
    done
    squeue
    tail -n 20 ./*.parts/*.log
    fail "waited $seconds s for: $*"
}
state() { scontrol show job "$1" 2>/dev/null | grep -o 'JobState=[A-Z_]*' | sort -u | tr '\n' ' '; }
is() { [ "$(state "$1")" = "JobState=$2 " ]; }
says() { grep -q -- "$2" "$1" 2>/dev/null; }

step "an array and its merge are one render"
"$FOGBOW" render "$scene" --size 32x32 --samples 10 -o whole.exr --progress none
mapfile -t jobs < <("$here/submit.sh" -n 10 -c 3 -o a.exr "$scene" --size 32x32)
await 60 is "${jobs[1]}" COMPLETED
is "${jobs[0]}" COMPLETED || fail "the array: $(state "${jobs[0]}")"
ls a.exr.parts
same a.exr whole.exr

step "a task that runs twice does no harm"
part=a.exr.parts/0000000003-0000000006.exr
before=$(stat -c %i "$part")
scontrol requeue "${jobs[0]}_1"
await 60 says a.exr.parts/1.log "$part: already there, skipped"
await 60 is "${jobs[0]}_1" COMPLETED
[ "$(stat -c %i "$part")" = "$before" ] || fail "$part was written again"
"$FOGBOW" merge a.exr.parts/*.exr --expect 0..10 -o b.exr --progress none
same b.exr whole.exr

step "merges of groups come to the same"
mapfile -t jobs < <(MERGE_FLAGS='--exposure 3' "$here/submit.sh" -n 10 -c 3 -p a.exr.parts -o e.exr -m 2 "$scene" \
    --size 32x32)
await 60 is "${jobs[2]}" COMPLETED
says a.exr.parts/merge.log '--exposure 3.* has no effect'
if says a.exr.parts/merge-0.log '--exposure'; then fail "flags of the last merge were those of a group"; fi
ls a.exr.parts/group-*.exr
same e.exr whole.exr

step "parts of another render are not taken for those of this one"
"$FOGBOW" render "$scene" --size 32x32 --samples 10 --seed 2 -o other.exr --progress none
mapfile -t jobs < <("$here/submit.sh" -n 10 -c 3 -o a.exr "$scene" --size 32x32 --seed 2)
await 60 is "${jobs[1]}" COMPLETED
same a.exr other.exr

step "crops go into one folder, adaptive ones, too"
for window in 0,0,32,16 0,16,32,32; do
    crop=(--size 32x32 --adaptive --crop "$window")
    "$FOGBOW" render "$scene" "${crop[@]}" --samples 40 -o "whole-$window.exr" --progress none
    mapfile -t jobs < <("$here/submit.sh" -n 40 -c 20 -m 2 -p crops.parts -o "crop-$window.exr" "$scene" "${crop[@]}")
    await 60 is "${jobs[2]}" COMPLETED
    same "crop-$window.exr" "whole-$window.exr"
done
ls crops.parts
"$FOGBOW" merge crop-*.exr --expect 0..40 -o crops.exr --progress none

step "a task that is killed leaves no file, and no merge; what is missing is rendered by the same command"
long=(--size 160x160)
"$FOGBOW" render "$scene" "${long[@]}" --samples 400 -o long.exr --progress none
mapfile -t jobs < <("$here/submit.sh" -n 400 -c 200 -o c.exr "$scene" "${long[@]}")
task=c.exr.parts/0000000200-0000000400.exr
running() { pgrep -f "^$FOGBOW render .*$task" >pid; }
await 60 running
sleep 1
kill -KILL "$(cat pid)"
await 60 is "${jobs[0]}_1" FAILED
[ ! -e "$task" ] || fail "$task is there"
await 60 is "${jobs[0]}_0" COMPLETED
await 60 is "${jobs[1]}" CANCELLED
[ ! -e c.exr ] || fail "c.exr was merged from what there was"
if "$FOGBOW" merge c.exr.parts/*.exr --expect 0..400 -o c.exr --progress none 2>message; then fail "merged"; fi
grep 'samples 200..400 are missing from every pixel' message
mapfile -t jobs < <("$here/submit.sh" -n 400 -c 200 -o c.exr "$scene" "${long[@]}")
await 120 is "${jobs[1]}" COMPLETED
says c.exr.parts/0.log 'already there, skipped' || fail "the part that was there was rendered again"
same c.exr long.exr

step "a task that makes way for another goes on later"
mapfile -t jobs < <(CHECKPOINT=1s "$here/submit.sh" -n 400 -c 200 -o d.exr -s --partition=low "$scene" "${long[@]}")
await 60 test -e d.exr.parts/0000000000-0000000200.exr.checkpoint
sbatch --partition=high --exclusive --output=high.log --wrap 'sleep 1'
await 90 says d.exr.parts/0.log 'goes back into the queue'
await 120 says d.exr.parts/0.log 'going on after'
await 120 is "${jobs[1]}" COMPLETED
cat d.exr.parts/0.log
same d.exr long.exr
[ -z "$(find d.exr.parts -name '*.checkpoint')" ] || fail "checkpoints were left"

step "all well"
