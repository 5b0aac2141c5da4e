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
    [[ -e $take/take.json ]] || fail "$take has no take.json: it is no take folder (docs/guide.md, What to bring, says what one holds)"
    printf '%s\n' "$take"
}

# The one file of a folder with this name, whatever its ending.
one_of() { # FOLDER NAME ENDING…
    local folder=$1 name=$2 ending
    shift 2
    for ending in "$@"; do
        if [[ -e $folder/$name.$ending ]]; then
            printf '%s\n' "$folder/$name.$ending"
            return
        fi
    done
    return 1
}

# The unit of a take's scan.
mesh_unit() { # TAKE
    python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["data"]["mesh_unit"] or "")' "$1/take.json"
}

need_stages() {
    local name
    for name in "$@"; do
        [[ -x $bin/$name ]] || fail "$bin has no $name: build the stages first (just build), or say in FURROW_BIN where they are"
    done
}

# --- steps, done once ------------------------------------------------------------------------------------------

# Makes a folder ready for steps. What was done there before is kept; with `again` it is done anew.
begin_run() { # OUT [AGAIN]
    local tool
    tool=$(basename "$0")
    run=$1
    if [[ -e $run && ! -e $run/keys/.$tool ]]; then
        [[ -d $run && -z $(ls -A "$run") ]] || fail "$run exists and is no run of $tool: name another folder"
    fi
    [[ -z ${2:-} ]] || rm -rf "$run/keys"
    mkdir -p "$run/keys" "$run/log"
    touch "$run/keys/.$tool"
    : >"$run/keys/.steps"
}

# Refuses what a user brings from the folder that a run makes.
refuse_within() { # FILE… (may be empty)
    local given
    for given in "$@"; do
        [[ -z $given || -e $given ]] || fail "there is no $given"
        if [[ -n $given && $(realpath -m "$given") == "$(realpath -m "$run")"/* ]]; then
            fail "$given is in $run, where a run makes its own files: put it beside the take first"
        fi
    done
}

# Files beyond this size are known by size and time, others by what they hold.
readonly LARGE_BYTES=50000000

# Says of files what they hold, and of a folder which files it has, how large and how old they are.
stamp() { # PATH...
    local path
    for path in "$@"; do
        if [[ -d $path ]]; then
            (cd "$path" && find -L . -type f -printf '%P %s %T@\n' | sort)
        elif [[ -e $path && $(stat -L -c %s "$path") -gt $LARGE_BYTES ]]; then
            stat -L -c '%s %Y' "$path"
        elif [[ -e $path ]]; then
            sha256sum <"$path"
        else
            echo "$path"
        fi
    done
}

# When files that a step made were last written, and how large they are.
marks() { # PATH...
    local path
    for path in "$@"; do
        if [[ -d $path ]]; then
            stamp "$path"
        else
            stat -c '%s %.9Y' "$path" 2>&1 || true
        fi
    done
}

# Does a step, unless it was done with the same inputs and words by the same programs, and what it made is as it was left. Its
# messages are kept. A step that is stopped leaves no key, so that nothing half done passes for done. CLEAR: a folder that is removed first.
step() { # NAME OUTPUT... : INPUT... -- PROGRAM WORD...
    local name=$1 outputs=() inputs=() key program TIMEFORMAT
    shift
    while [[ $1 != : ]]; do
        outputs+=("$1")
        shift
    done
    shift
    while [[ $1 != -- ]]; do
        inputs+=("$1")
        shift
    done
    shift
    echo "$name" >>"$run/keys/.steps"
    key=$(printf '%s\0' "$@" | cat - <(stamp "${inputs[@]}") <(stat -L -c '%s %Y' "$bin/$1") | sha256sum)
    if [[ -e $run/keys/$name && $(head -n -1 "$run/keys/$name") == "$key"$'\n'"$(marks "${outputs[@]}")" ]]; then
        return
    fi
    rm -f "$run/keys/$name"
    [[ -z ${CLEAR:-} ]] || rm -rf "$CLEAR"
    program=$1
    shift
    {
        TIMEFORMAT='%R %U %S'
        time "$bin/$program" "$@" 2> >(tee "$run/log/$name.txt" >&3)
    } 3>&2 2>"$run/.seconds" ||
        fail "$name did not end (see above; the log is $run/log/$name.txt). What was done before it is kept: call this again"
    { printf '%s\n' "$key" && marks "${outputs[@]}" && cat "$run/.seconds"; } >"$run/.key"
    mv "$run/.key" "$run/keys/$name"
}
