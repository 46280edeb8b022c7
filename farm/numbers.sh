# shellcheck shell=bash
# Numbers on command lines; sourced by the scripts here.

fail() { echo "error: $*" >&2 && exit 2; }

# The whole number $2, with or without zeros before it, but not below $3; $1 is what it is called.
number() {
    local digits
    [[ $2 =~ ^0*([0-9]{1,10})$ ]] || fail "$1 is to be a whole number, but is '$2'"
    digits=$((10#${BASH_REMATCH[1]}))
    [ "$digits" -ge "$3" ] || fail "$1 is to be at least $3, but is $2"
    echo "$digits"
}
