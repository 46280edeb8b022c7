#!/usr/bin/env bash
# Runs farm/render-part.sh and farm/merge-parts.sh as a manager would. FOGBOW is the program (default: the release
# build). Takes seconds.
set -euo pipefail
trap 'echo "FAILED in line $LINENO" >&2' ERR
here=$(cd "$(dirname "$0")" && pwd)
export FOGBOW=${FOGBOW:-${CARGO_TARGET_DIR:-$here/../target}/release/fogbow}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
flags=("$here/scene.toml" parts --size 24x24 --threads 1)
"$FOGBOW" render "$here/scene.toml" --size 24x24 --samples 11 -o whole.exr --progress none
# In no order, one of them twice, one of them lost.
for range in '9 11' '1 4' '5 8' '1 4'; do
    read -r first last <<<"$range"
    "$here/render-part.sh" "$first" "$last" "${flags[@]}" --progress alf >log 2>message
    grep -q '^ALF_PROGRESS 100%$' log
done
rm parts/0000000004-0000000008.exr
if "$here/merge-parts.sh" parts 11 out.exr 2>message; then echo "FAILED: merged" && exit 1; fi
grep 'samples 4..8 are missing from every pixel' message
# Managers pad numbers with zeros; 08 is no octal number.
"$here/render-part.sh" 0005 08 "${flags[@]}" --progress none
"$here/merge-parts.sh" parts 11 out.exr
"$FOGBOW" compare out.exr whole.exr | grep 'the same exact sums of the same samples'

# Crops go into one folder, and all of them have to be there.
for crop in 0,0,24,10 0,10,24,24; do
    if "$here/merge-parts.sh" crops 11 out.exr 2>message; then echo "FAILED: merged a crop" && exit 1; fi
    "$here/render-part.sh" 1 11 "$here/scene.toml" crops --size 24x24 --progress none --crop "$crop"
done
ls crops
grep -- '--crop 0,10,24,24' message
"$here/merge-parts.sh" crops 11 crops.exr
"$FOGBOW" compare crops.exr whole.exr | grep 'the same exact sums of the same samples'

# A part that is there is left out; that of another render is not.
"$here/render-part.sh" 1 4 "${flags[@]}" 2>message
grep 'parts/0000000000-0000000004.exr: already there, skipped' message
"$here/render-part.sh" 1 11 "$here/scene.toml" crops --size 24x24 --crop 0,0,24,10 --seed 2 2>message
if grep skipped message; then echo "FAILED: took a part of another seed" && exit 1; fi

# Adaptive parts are checked, too.
adaptive=("$here/scene.toml" adaptive --size 160x96 --threads 1 --progress none --adaptive)
"$FOGBOW" render "$here/scene.toml" --size 160x96 --adaptive --samples 60 -o adaptive.exr --progress none
"$here/render-part.sh" 1 25 "${adaptive[@]}"
"$here/render-part.sh" 41 60 "${adaptive[@]}"
if "$here/merge-parts.sh" adaptive 60 out.exr 2>message; then echo "FAILED: merged" && exit 1; fi
grep 'samples 25..40 of the mean pixel are missing from every pixel' message
"$here/render-part.sh" 26 40 "${adaptive[@]}"
"$here/merge-parts.sh" adaptive 60 out.exr
"$FOGBOW" compare out.exr adaptive.exr | grep 'the same exact sums of the same samples'

# What makes no sense is refused with a reason.
refused() {
    local reason=$1
    shift
    if "$@" 2>message; then echo "FAILED: $*" && exit 1; fi
    grep -- "$reason" message
}
refused "FIRST is to be a whole number, but is 'x'" "$here/render-part.sh" x 4 "${flags[@]}"
refused "LAST is to be a whole number, but is '-4'" "$here/render-part.sh" 1 -4 "${flags[@]}"
refused 'FIRST is to be at least 1' "$here/render-part.sh" 00 4 "${flags[@]}"
refused 'LAST is to be at least FIRST' "$here/render-part.sh" 4 3 "${flags[@]}"
refused "SAMPLES is to be a whole number, but is '1e3'" "$here/merge-parts.sh" parts 1e3 x.exr
mkdir empty
refused 'there are no parts in empty' "$here/merge-parts.sh" empty 11 x.exr
