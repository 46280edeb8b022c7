# shellcheck shell=bash
# Which samples the tasks of an array render, and where to.

# The first sample of task $1.
first() { echo $(($1 * CHUNK)); }

# The number after its last sample.
end() {
    local end=$((($1 + 1) * CHUNK))
    echo $((end < SAMPLES ? end : SAMPLES))
}

# Its file.
part() { printf '%s/%010d-%010d.exr\n' "$PARTS" "$(first "$1")" "$(end "$1")"; }
