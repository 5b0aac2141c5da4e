# shellcheck shell=bash
# What tools that work on a take's folder share; to be sourced. Sets `root` and `bin`.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=${FURROW_BIN:-$root/target/release}

fail() {
    printf '%s: %s\n' "$(basename "$0")" "$*" >&2
    exit 1
}
say() { printf '\n\033[1m%s\033[0m\n' "$1" >&2; }

# Prints the tool's own head comment, from its second line on.
usage() {
    sed -n '2,/^[^#]/s/^#\( \|$\)//p' "$0" >&2
    exit 2
}

# Says where the take is: what virtual-rig makes holds it beside its truth.
take_folder() { # TAKE
    local take=${1%/}
    if [[ ! -e $take/take.json && -e $take/take/take.json ]]; then
        take=$take/take
    fi
    [[ -e $take/take.json ]] || fail "$take has no take.json: it is no take folder"
    printf '%s\n' "$take"
}

need_stages() {
    local name
    for name in "$@"; do
        [[ -x $bin/$name ]] || fail "$bin has no $name: build the stages first (just build), or say in FURROW_BIN where they are"
    done
}
