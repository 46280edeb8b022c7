#!/usr/bin/env bash
# Renders one part, for managers that count frames: samples FIRST to LAST, counted from 1, both included.
#
#   render-part.sh FIRST LAST SCENE PARTS [FLAG]...
#
# The part goes into the folder PARTS; FLAGs are those of fogbow render. A part of a crop has that in its name, so that
# crops can go into one folder. FOGBOW names another program than fogbow, CHECKPOINT another time than 60s between
# checkpoints. A task that is run again goes on from its checkpoint, and has nothing to do if its part is there.
set -euo pipefail
# shellcheck source=farm/numbers.sh
. "$(dirname "${BASH_SOURCE[0]}")/numbers.sh"
if [ $# -lt 4 ]; then
    sed -n '4p' "$0" >&2
    exit 2
fi
first=$(number FIRST "$1" 1)
end=$(number LAST "$2" 1)
scene=$3 parts=$4
[ "$first" -le "$end" ] || fail "LAST is to be at least FIRST, but samples $first to $end were given"
first=$((first - 1))
shift 4
mkdir -p "$parts"
exec "${FOGBOW:-fogbow}" render "$scene" --sample-range "$first..$end" --checkpoint "${CHECKPOINT:-60s}" --resume \
    -o "$parts/$(printf '%010d-%010d' "$first" "$end")$(crop_suffix "$@").exr" "$@"
