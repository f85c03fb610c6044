#!/usr/bin/env bash
# Makes the README's pictures anew, with the program as it is. A change of what they show is a change to look at.
#   scripts/pictures.sh            all of them
#   scripts/pictures.sh viewer     only those of the viewer's window
#   scripts/pictures.sh check      those of the window, small and of early moments, to see that they can be made
set -euo pipefail
# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

# Kilobytes that a stored picture of the window may have.
readonly MOST_KB=150

# NAME, the moment in seconds, then what `hammerfall render` gets: the viewer's main states.
window_pictures() {
    window viewer 0.02 brick-pile --panels
    window viewer-gallery 0 bounce --panels=gallery
    window viewer-plots 0.06 brick-pile --panels=plots
    window viewer-element 0.075 pile-press --panels=element --color-by failure-index
    window viewer-dark 0.24 hammer-lamp --panels --dark --color-by von-mises
}

window() {
    local name="$1" at="$2" size=1280x800
    shift 2
    if [ "$mode" = check ]; then size=640x420 at=0.001; fi
    say "drawing $name"
    cargo run --locked --quiet -- render "$@" --at "$at" --size "$size" --few-colors -o "$folder/$name.png"
    [ "$(wc -c <"$folder/$name.png")" -lt $((MOST_KB * 1000)) ] || fail "$name.png is larger than $MOST_KB kB"
}

scene_pictures() {
    for scene in hammer-ground hammer-table hammer-lamp rods-collision; do
        say "rendering $scene-fine"
        cargo run --locked --quiet -- render "$scene-fine" -o "assets/pictures/$scene.gif" --size 480x270 --fps 14
    done
    for scene in brick-pile mug-drop pane-shot; do
        say "rendering $scene"
        cargo run --locked --quiet -- render "$scene" -o "assets/pictures/$scene.gif" --size 480x270 --fps 10
    done
    for criterion in tensile mohr-coulomb tresca; do
        say "rendering plate-$criterion-fine"
        cargo run --locked --quiet -- render "plate-$criterion-fine" -o "assets/pictures/plate-$criterion.png" --at 0.459 --size 480x300 --no-caption
        cargo run --locked --quiet -- render "plate-$criterion-fine" -o "assets/pictures/plate-$criterion-cut.png" --at 0.459 --size 480x200 --no-caption \
            --camera section --cut y
    done
    say "rendering pile-press-fine"
    cargo run --locked --quiet -- render pile-press-fine -o assets/pictures/pile-band.png --at 0.2155 --size 300x480 --no-caption
    say "rendering pile-split"
    cargo run --locked --quiet -- render pile-split -o assets/pictures/pile-split.png --at 0.16 --size 300x480 --no-caption
    say "drawing the failure criteria"
    cargo run --locked --quiet -- criteria -o assets/pictures/criteria.png
}

mode="${1:-all}"
folder=assets/pictures
case "$mode" in
    all | viewer) ;;
    check) folder="$(mktemp -d)" ;;
    *) fail "usage: scripts/pictures.sh [viewer | check]" ;;
esac
ensure_rust
ensure_linker
ensure_vulkan software
ensure_runtime_dir
cargo build --locked
window_pictures
if [ "$mode" = all ]; then scene_pictures; fi
if [ "$mode" = check ]; then rm -r "$folder"; fi
