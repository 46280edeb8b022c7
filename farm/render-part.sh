#!/usr/bin/env bash
# Renders one part, for managers that count frames: samples FIRST to LAST, counted from 1, both included.
#
#   render-part.sh FIRST LAST SCENE PARTS [FLAG]...
#
# The part goes into the folder PARTS; FLAGs are those of fogbow render. FOGBOW names another program than fogbow,
# CHECKPOINT another time than 60s between checkpoints. A task that is run again goes on from its checkpoint.
set -euo pipefail
if [ $# -lt 4 ] || [ "$1" -lt 1 ] || [ "$2" -lt "$1" ]; then
    sed -n '4p' "$0" >&2
    exit 2
fi
first=$(($1 - 1)) end=$2 scene=$3 parts=$4
shift 4
mkdir -p "$parts"
exec "${FOGBOW:-fogbow}" render "$scene" --sample-range "$first..$end" --checkpoint "${CHECKPOINT:-60s}" --resume \
    -o "$parts/$(printf '%010d-%010d.exr' "$first" "$end")" "$@"
