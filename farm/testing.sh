# What the tests of farm/openjd and farm/slurm have in common; they source it. It leaves the program in FOGBOW (default:
# the release build) and the scene in scene.

trap 'echo "FAILED in line $LINENO" >&2' ERR
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export FOGBOW=${FOGBOW:-${CARGO_TARGET_DIR:-$root/target}/release/fogbow}
export scene=$root/farm/scene.toml

not_run() { echo "not run: $*" && exit 77; }
fail() { echo "FAILED: $*" >&2 && exit 1; }
step() { printf '\n== %s\n' "$*"; }
# Whether there are all of these commands.
has() { for name in "$@"; do command -v "$name" >/dev/null || return 1; done; }
# Fails unless images $1 and $2 have the same bits.
same() {
    local report
    report=$("$FOGBOW" compare "$1" "$2" --json)
    grep -q '"same_sums":true' <<<"$report" || fail "$1 and $2 have other sums: $report"
    [ "$(grep -o '"rmse":0.0' <<<"$report" | wc -l)" = 3 ] || fail "$1 and $2 differ: $report"
    echo "$1 and $2: the same bits"
}

[ -x "$FOGBOW" ] || not_run "there is no $FOGBOW; build it, or name it in FOGBOW"
