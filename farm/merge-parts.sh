#!/usr/bin/env bash
# Merges the parts in the folder PARTS, which are to have SAMPLES samples per pixel, no fewer and no more.
#
#   merge-parts.sh PARTS SAMPLES OUT.exr [FLAG]...
#
# FLAGs are those of fogbow merge. FOGBOW names another program than fogbow.
set -euo pipefail
if [ $# -lt 3 ]; then
    sed -n '4p' "$0" >&2
    exit 2
fi
parts=$1 samples=$2 out=$3
shift 3
exec "${FOGBOW:-fogbow}" merge "$parts"/*[0-9]-*[0-9].exr --expect "0..$samples" -o "$out" "$@"
