#!/usr/bin/env bash
# Makes a small report with `fogbow paper`, opens it from disk in headless Chromium and uses its viewer: flip, wipe,
# error map, zoom inset, exposure. FOGBOW is the program (default: the release build). With a folder as its argument it
# leaves screenshots there. Takes less than a minute. Exit code 77: not run.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source-path=SCRIPTDIR source=../../farm/testing.sh
. "$here/../../farm/testing.sh"
has chromium chromedriver || not_run "there is no chromium or no chromedriver; Debian has packages of these names"
has python3 || not_run "there is no python3"
shots=${1:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

step "make a report"
"$FOGBOW" paper table1 fig3 fig7 fig11 --budget 6s --scenes "$root/scenes" -o "$work/report"

step "use it in a browser"
python3 "$here/browse.py" "$work/report/index.html" ${shots:+"$shots"}

step "all well"
