#!/usr/bin/env bash
# Merges the parts in the folder PARTS, which are to have SAMPLES samples per pixel, no fewer and no more, or adaptive
# ones that many in the mean.
#
#   merge-parts.sh PARTS SAMPLES OUT.exr [FLAG]...
#
# FLAGs are those of fogbow merge; --crop names the pixels if the parts are all of one crop. FOGBOW names another program
# than fogbow.
set -euo pipefail
# shellcheck source=farm/numbers.sh
. "$(dirname "${BASH_SOURCE[0]}")/numbers.sh"
if [ $# -lt 3 ]; then
    sed -n '5p' "$0" >&2
    exit 2
fi
samples=$(number SAMPLES "$2" 1)
parts=$1 out=$3
shift 3
shopt -s nullglob extglob
files=("$parts"/+([0-9])-+([0-9])?(-crop-*).exr)
[ ${#files[@]} -gt 0 ] || fail "there are no parts in $parts: files such as 0000000000-0000000016.exr"
# As a list, for there may be more of them than fit on a command line.
exec "${FOGBOW:-fogbow}" merge "@"<(printf '%s\n' "${files[@]}") --expect "0..$samples" -o "$out" "$@"
