# shellcheck shell=bash
# Which samples the tasks of an array render, and where to.

# The first sample of task $1.
first() { echo $(($1 * CHUNK)); }

# The number after its last sample.
end() {
    local end=$((($1 + 1) * CHUNK))
    echo $((end < SAMPLES ? end : SAMPLES))
}

# Its file; the crop is in its name, so that crops can go into one folder.
part() { printf '%s/%010d-%010d%s.exr\n' "$PARTS" "$(first "$1")" "$(end "$1")" "$CROP_SUFFIX"; }

# The file of group $1 of parts.
group() { printf '%s/group-%d%s.exr\n' "$PARTS" "$1" "$CROP_SUFFIX"; }
