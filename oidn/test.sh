#!/usr/bin/env bash
# Runs the tests of --denoise with Open Image Denoise itself, which it installs into a folder of its own from the Python
# package pyoidn, and denoises a render and a merge of parts with the program. FOGBOW is the program (default: the release
# build). Takes less than a minute once the tests are built. Exit code 77: not run.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source-path=SCRIPTDIR source=../farm/testing.sh
. "$here/../farm/testing.sh"
has python3 cargo || not_run "there is no python3 or no cargo"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

step "install Open Image Denoise"
{ python3 -m venv "$work/venv" && "$work/venv/bin/pip" install -q --no-deps pyoidn==2.5.1.0; } >"$work/log" 2>&1 ||
    not_run "pyoidn 2.5.1.0 cannot be installed: $(tail -n 1 "$work/log")"
library=$(find "$work/venv" -name 'libOpenImageDenoise*' | head -n 1)
[ -n "$library" ] || not_run "pyoidn has no library for this system"
folder=$(dirname "$library")
export LD_LIBRARY_PATH=$folder${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export DYLD_LIBRARY_PATH=$LD_LIBRARY_PATH

# Runs cargo test with these arguments; fails if a test, or none, was run without the library.
tests() {
    (cd "$root" && cargo test --release "$@") 2>&1 | tee "$work/log"
    if grep -q '^not run: .*cannot be used\|^not run: .*OpenImageDenoise' "$work/log"; then fail "not with the library"; fi
    grep -q '^test result: ok. [1-9]' "$work/log" || fail "there are no such tests"
}
step "tests of the crate"
tests -p fogbow-oidn --test denoise
step "tests of --denoise"
tests --test cli denoised

# The largest RMSE of a channel of image $1 against the truth.
rmse() {
    local python='import json, sys; print(max(c["rmse"] for c in json.load(sys.stdin)["channels"]))'
    "$FOGBOW" compare "$1" truth.exr --json | python3 -c "$python"
}

step "a render"
cd "$work"
base=("$root/scenes/cornell-fog" --size 64x64 --progress none)
"$FOGBOW" render "${base[@]}" --samples 8 --denoise -o a.exr -o a.png
"$FOGBOW" render "${base[@]}" --samples 1024 --seed 8 -o truth.exr
"$FOGBOW" info a.denoised.exr | grep '^denoised: Open Image Denoise 2\.'
[ -s a.denoised.png ] || fail "there is no a.denoised.png"
noisy=$(rmse a.exr) denoised=$(rmse a.denoised.exr)
echo "RMSE $noisy, without noise $denoised"
awk "BEGIN { exit !($denoised < 0.7 * $noisy) }" || fail "there is not less noise"

step "a merge"
for range in '1 5' '6 8'; do
    read -r first last <<<"$range"
    "$root/farm/render-part.sh" "$first" "$last" "${base[0]}" parts "${base[@]:1}" --aov albedo,normal
done
"$root/farm/merge-parts.sh" parts 8 b.exr --denoise
same a.exr b.exr
"$FOGBOW" info b.denoised.exr | grep '^denoised: '
if "$FOGBOW" merge a.denoised.exr -o c.exr 2>message; then fail "a denoised image was merged"; fi
grep 'give the noisy one, a.exr' message

step "all well"
