# shellcheck shell=bash disable=SC2154
# Contact sheets and scores of a run of tools/take, which sources this; its variables are meant.

readonly SHEET_FRAMES=4 CELL=480x360

sheets=()

draw_sheets() {
    unit=$(mesh_unit "$take")
    mkdir -p "$out/pictures" "$out/scores"
    up=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["data"]["mesh_up"])' "$take/take.json")
    mesh=(--mesh "$scan" --unit "$unit" --up "$up")
    result=$large/large-scale
    [[ -z $folded ]] || result=$medium/wrinkled
    local frames
    frames=$("$root/tools/take-report" --frames-of "$result.json" 5)
    step frames "$out/frames.png" : "$scan" "$result.json" "$result.pc2" -- preview "${mesh[@]}" --sequence "$result.json" --frames "$frames" \
        --columns 5 --size 360 --title 'What the footage makes of the scan' --out "$out/frames.png"
    sheets+=("$out/frames.png: the face over the take")
    [[ -n $folded ]] || return 0
    local frame camera
    while read -r frame camera; do
        draw_sheet "$frame" "$camera"
    done < <(chosen_frames)
}

# Frames to draw, and the camera that saw most of each.
chosen_frames() {
    local list=("$root/tools/take-report" --frames "$medium/valleys.jsonl" "$wrinkles/sections.jsonl")
    if [[ -n $pictures ]]; then
        "${list[@]}" 1000 | grep -wE "${pictures//,/|}" || fail "none of the frames $pictures has wrinkles in an image"
    else
        "${list[@]}" $SHEET_FRAMES
    fi
}

# A frame, as a camera saw it and as it was found: all of the face, and a part of it near by.
draw_sheet() { # FRAME CAMERA
    local frame=$1 camera=$2 name=$2-$1 at=$out/pictures view part box cells=() names=() close=() columns=3
    local sections=$wrinkles/sections.jsonl curves=$wrinkles/edited-wrinkles.jsonl
    [[ ! -e $medium/named.jsonl ]] || sections=$medium/named.jsonl
    view=$("$root/tools/take-report" --view "$take/take.json" "$capture/cameras.json" "$large/warp.json" "$large/pose.jsonl" "$camera" "$frame")
    read -r part box < <("$root/tools/take-report" --part "$medium/valleys.jsonl" "$sections" "$capture/cameras.json" "$camera" "$frame") || return 0
    CLEAR=$at/film-$name step "film-$name" "$at/film-$name" : "$curves" "$capture/sync/frames.json" -- wrinkle-track show --frames "$capture/sync/frames.json" \
        --sync "$capture/sync/sync.jsonl" --curves "$curves" --camera "$camera" --range "$frame-$frame" --out "$at/film-$name"
    local film image
    film=$(find "$at/film-$name" -name '*.png')
    image=$(find -L "$capture/sync/$camera" -name "*$frame.*" | head -n 1)
    [[ $image != *.png ]] || film=$image
    local curves_film
    curves_film=$(find "$at/film-$name" -name '*.png')
    cells=("$curves_film") names=("frame $frame, camera $camera")
    close=("$film@$part")
    draw_face large "$large/large-scale" 'without wrinkles'
    draw_face wrinkled "$medium/wrinkled" 'with wrinkles'
    if [[ -n $truth ]]; then
        draw_face true "$truth/wrinkled" 'true surface'
        draw_face error "$medium/wrinkled" 'error, 0–1 mm' --reference "$truth/wrinkled.json" --range-mm 0-1
        columns=5
    fi
    step "sheet-$name" "$out/sheet-$name.png" : "${cells[@]%@*}" "${close[@]%@*}" -- preview tile "${cells[@]}" "${close[@]}" --columns $columns --size $CELL \
        "${names[@]/#/--name=}" --out "$out/sheet-$name.png"
    sheets+=("$out/sheet-$name.png: frame $frame as camera $camera saw it, and what was made of it")
}

# A surface in the frame, whole and near by, added to the sheet's cells.
draw_face() { # NAME SEQUENCE CAPTION OPTION...
    local kind=$1 sequence=$2 caption=$3 picture=$at/$1-$name look
    shift 3
    look=("${mesh[@]}" --sequence "$sequence.json" --frames "$frame" --view="$view" --size $CELL)
    step "$kind-$name" "$picture.png" : "$scan" "$sequence.json" "$sequence.pc2" -- preview "${look[@]}" "$@" --out "$picture.png"
    step "$kind-close-$name" "$picture-close.png" : "$scan" "$sequence.json" "$sequence.pc2" -- preview "${look[@]}" "$@" --crop="$box" --out "$picture-close.png"
    # Without preview's own caption and bar.
    cells+=("$picture.png@0,0,${CELL/x/,}") names+=("$caption")
    close+=("$picture-close.png@0,0,${CELL/x/,}")
}

# Every intermediate beside the truth of a virtual take.
score_run() {
    # Boards do not know where the truth's world has its origin: up to one rigid motion of the whole take.
    score head head-trajectories "$large/head.jsonl"
    score large-scale large-scale "$large/large-scale.json"
    [[ -n $folded ]] || return 0
    # Valleys are known in frames with images only, and have the names of the truth if any.
    "$root/tools/same-wrinkles" "$medium/valleys.jsonl" --truth "$truth" "$out/scores/valleys"
    score valleys valleys "$out/scores/valleys/valleys.jsonl" --truth "$out/scores/valleys/truth"
    # Two seconds a frame: those that are drawn.
    local frame camera
    while read -r frame camera; do
        score "wrinkled-$frame" wrinkled "$medium/wrinkled.json" --against "$large/large-scale.json" --frames "$frame-$frame" --stage "frame $frame"
    done < <(chosen_frames)
}

score() { # NAME KIND RESULT OPTION...
    local name=$1 kind=$2 file=$3
    shift 3
    [[ " $* " == *" --truth "* ]] || set -- "$@" --truth "$truth"
    if "$bin/virtual-rig" score "$kind" "$file" "$@" --json --quiet >"$out/scores/$name.json"; then
        scores+=("$out/scores/$name.json")
    else
        printf 'the truth says nothing of %s (see above)\n' "$name" >&2
    fi
}
