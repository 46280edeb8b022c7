# shellcheck shell=bash
# Numbers on command lines, and names of parts; sourced by the scripts here.

fail() { echo "error: $*" >&2 && exit 2; }

# The whole number $2, with or without zeros before it, but not below $3; $1 is what it is called.
number() {
    local digits
    [[ $2 =~ ^0*([0-9]{1,10})$ ]] || fail "$1 is to be a whole number, but is '$2'"
    digits=$((10#${BASH_REMATCH[1]}))
    [ "$digits" -ge "$3" ] || fail "$1 is to be at least $3, but is $2"
    echo "$digits"
}

# What the name of a part says of the crop among the flags of fogbow render, if there is one: -crop-0_0_64_32.
crop_suffix() {
    local window
    window=$(crop_window "$@")
    [ -z "$window" ] || echo "-crop-${window//[^0-9]/_}"
}

# That crop: 0,0,64,32.
crop_window() {
    [[ ! " $* " =~ \ --crop[\ =]([^\ ]*)\  ]] || echo "${BASH_REMATCH[1]}"
}
