#!/usr/bin/env bash
# Runs farm/openjd/fogbow.yaml for real, with openjd-cli, which it installs into a folder of its own. FOGBOW is the
# program (default: the release build). Takes less than a minute. Exit code 77: not run.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source-path=SCRIPTDIR source=../testing.sh
. "$here/../testing.sh"
job=$here/fogbow.yaml
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
step "install openjd-cli"
{ python3 -m venv venv && venv/bin/pip install -q openjd-cli==0.8.0; } >install.log 2>&1 ||
    not_run "openjd-cli 0.8.0 cannot be installed: $(tail -n 1 install.log)"
openjd=venv/bin/openjd

# Runs the job in folder $1, of samples $2 in chunks of $3; what follows are further arguments of openjd.
run() {
    local folder=$1 samples=$2 chunk=$3
    shift 3
    "$openjd" run "$job" -p "Scene=$scene" -p "Parts=$work/$folder/parts" -p "Output=$work/$folder/out.exr" \
        -p "Samples=$samples" -p "Chunk=$chunk" -p "Fogbow=$FOGBOW" -p Threads=1 -p "Flags=$flags" "$@"
}
# Fails unless line $2 is in the log $1.
says() { grep -q -- "$2" "$1" || { tail -n 40 "$1" && fail "$1 does not say: $2"; }; }

step "the template is valid"
"$openjd" check "$job"

step "render and merge are one render"
flags='--size 32x32 --seed 7'
# shellcheck disable=SC2086
"$FOGBOW" render "$scene" $flags --samples 10 -o whole.exr --progress none
run a 10 4 -p MergeFlags='--exposure 3' --step Merge --run-dependencies >a.log || { cat a.log && fail "the job"; }
ls a/parts
same a/out.exr whole.exr
for line in 'openjd_progress: 100.00' 'openjd_status: .*3 samples per pixel' 'openjd_status: .*: 3 images, 10 samples'; do
    says a.log "$line"
done
says a.log '--exposure 3.* has no effect'

step "a task that runs twice does no harm"
part=a/parts/0000000004-0000000007.exr
before=$(stat -c %i "$part")
run a 10 4 --step Render --task-param Sample=5-7 >b.log
says b.log "$part: already there, skipped"
[ "$(stat -c %i "$part")" = "$before" ] || fail "$part was written again"
run a 10 4 --step Merge --no-run-dependencies >b.log
same a/out.exr whole.exr

step "merges in two steps come to the same"
run a 10 4 -p Merges=2 --step Merge --run-dependencies >h.log || { cat h.log && fail "the job"; }
ls a/parts
says h.log 'openjd_status: .*group-1.exr: 1 image, 4 samples'
says h.log 'openjd_status: .*group-2.exr: 2 images, 6 samples'
says h.log 'openjd_status: .*out.exr: 2 images, 10 samples'
same a/out.exr whole.exr
run a 10 4 -p Merges=5 --step Merge --run-dependencies >h.log || { cat h.log && fail "the job"; }
says h.log 'openjd_status: .*out.exr: 3 images, 10 samples'
same a/out.exr whole.exr

step "crops go into one folder"
for window in 0,0,32,16 0,16,32,32; do
    flags="--size 32x32 --seed 7 --crop $window"
    run crop 10 4 -p Merges=2 --step Merge --run-dependencies >i.log || { cat i.log && fail "the job"; }
    mv crop/out.exr "crop/$window.exr"
done
ls crop/parts
"$FOGBOW" merge crop/0,*.exr -o crop/out.exr --progress none
same crop/out.exr whole.exr

step "adaptive parts merge, and are checked"
flags='--size 160x96 --adaptive'
# shellcheck disable=SC2086
"$FOGBOW" render "$scene" $flags --samples 60 -o adaptive.exr --progress none
run adaptive 60 20 -p Merges=2 --step Merge --run-dependencies >j.log || { cat j.log && fail "the job"; }
same adaptive/out.exr adaptive.exr
flags='--size 32x32 --seed 7'

step "a task that is killed leaves no file, and no merge"
rm a/out.exr "$part"
flags='--size 512x512'
if run a 100000 100000 --step Render --task-param Sample=5-100000 >c.log 2>&1; then fail "not killed"; fi &
killed() { pgrep -f "^$FOGBOW render .*/0000000004-0000100000.exr" >pid; }
for _ in $(seq 300); do
    if killed; then break; fi
    sleep 0.1
done
sleep 1
[ -s pid ] || { cat c.log && fail "it did not start"; }
kill -KILL "$(cat pid)"
wait $!
flags='--size 32x32 --seed 7'
says c.log 'exited with code'
[ ! -e a/parts/0000000004-0000100000.exr ] || fail "there is a file of the task that was killed"
if run a 10 4 --step Merge --no-run-dependencies >d.log 2>&1; then fail "merged"; fi
says d.log 'openjd_fail: --expect 0..10: samples 4..7 are missing from every pixel'
[ ! -e a/out.exr ] || fail "an image was written"
run a 10 4 --step Render --task-param Sample=5-7 >e.log
run a 10 4 --step Merge --no-run-dependencies >e.log
same a/out.exr whole.exr

step "a task that is canceled goes on later"
long='--size 128x128'
# shellcheck disable=SC2086
"$FOGBOW" render "$scene" $long --samples 300 -o long.exr --progress none
flags=$long
if run f 300 300 -p Checkpoint=1s --step Render >f.log 2>&1; then fail "not stopped"; fi &
stopped() { pgrep -f "^$FOGBOW render .*f/parts/0000000000-0000000300.exr" >pid && ls f/parts/*.checkpoint; }
for _ in $(seq 300); do
    if stopped >/dev/null 2>&1; then break; fi
    sleep 0.1
done
kill -TERM "$(cat pid)"
wait $!
says f.log 'openjd_status: stopped after .* per pixel.*; --resume goes on from'
says f.log 'exited with code: 75'
run f 300 300 -p Checkpoint=1s --step Merge --run-dependencies >g.log
says g.log 'openjd_status: going on after'
same f/out.exr long.exr

step "all well"
