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
grep 'no part has samples 4..8' message
"$here/render-part.sh" 5 8 "${flags[@]}" --progress none
"$here/merge-parts.sh" parts 11 out.exr
"$FOGBOW" compare out.exr whole.exr | grep 'the same exact sums of the same samples'
