#!/usr/bin/env bash
# Renders a scene in parts as an array of Slurm, and merges them. See docs/farm.md.
#
#   submit.sh [-n SAMPLES] [-c CHUNK] [-p PARTS] [-o OUT.exr] [-m MERGES] [-s SBATCH_FLAG]... SCENE [FLAG]...
#
# SAMPLES per pixel, CHUNK of them per task, parts in the folder PARTS (default: OUT.exr.parts). FLAGs are those of
# fogbow render, but for --threads, which are those that Slurm gives. With -m, so many merges of equal numbers of parts
# come first, at the same time, and then one of what they made. With -s, flags of sbatch for the tasks, as in
# -s --partition=low. Given again, it renders only the parts that are not there, or are of another render: all other
# tasks end at once. FOGBOW names another program than fogbow, CHECKPOINT another time than 60s between checkpoints, or
# off, MERGE_FLAGS flags of fogbow merge for the last merge. Prints the numbers of the jobs: of the tasks, of the merges
# of groups (with -m), and of the last merge.
set -euo pipefail

usage() {
    sed -n '4,12s/^# \{0,1\}//p' "$0" >&2
    exit 2
}

samples=256 chunk=16 parts='' output=image.exr merges=1
sbatch_flags=()
while getopts n:c:p:o:m:s: option; do
    case $option in
    n) samples=$OPTARG ;;
    c) chunk=$OPTARG ;;
    p) parts=$OPTARG ;;
    o) output=$OPTARG ;;
    m) merges=$OPTARG ;;
    s) sbatch_flags+=("$OPTARG") ;;
    *) usage ;;
    esac
done
shift $((OPTIND - 1))
if [ $# -lt 1 ]; then usage; fi
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=farm/numbers.sh
. "$here/../numbers.sh"
samples=$(number -n "$samples" 1)
chunk=$(number -c "$chunk" 1)
merges=$(number -m "$merges" 1)
export SCENE=$1 SAMPLES=$samples CHUNK=$chunk OUTPUT=$output PARTS=${parts:-$output.parts}
export FOGBOW=${FOGBOW:-fogbow} CHECKPOINT=${CHECKPOINT:-60s}
shift
CROP=$(crop_window "$@") CROP_SUFFIX=$(crop_suffix "$@")
export CROP CROP_SUFFIX
mkdir -p "$PARTS"

# Whether a part is there, and of this very render, is for its task to say.
tasks=$(((samples + chunk - 1) / chunk))
export MERGES=$((merges < tasks ? merges : tasks))
job=$(sbatch --parsable --export=ALL --array="0-$((tasks - 1))" --output="$PARTS/%a$CROP_SUFFIX.log" \
    "${sbatch_flags[@]}" "$here/render.sbatch" "$here" "$@")
echo "${job%%;*}"
after=(--dependency="afterok:${job%%;*}" --kill-on-invalid-dep=yes)
if [ "$MERGES" -gt 1 ]; then
    groups=$(sbatch --parsable --export=ALL --array="0-$((MERGES - 1))" --output="$PARTS/merge-%a$CROP_SUFFIX.log" \
        "${after[@]}" "$here/merge.sbatch" "$here")
    echo "${groups%%;*}"
    after=(--dependency="afterok:${groups%%;*}" --kill-on-invalid-dep=yes)
fi
merge=$(sbatch --parsable --export=ALL --output="$PARTS/merge$CROP_SUFFIX.log" "${after[@]}" "$here/merge.sbatch" \
    "$here")
echo "${merge%%;*}"
