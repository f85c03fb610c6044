#!/usr/bin/env bash
# Makes the README's pictures anew, with the program as it is. A change of what they show is a change to look at.
set -euo pipefail
# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

ensure_rust
ensure_linker
ensure_vulkan software
ensure_runtime_dir
cargo build --locked
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
    cargo run --locked --quiet -- render "plate-$criterion-fine" -o "assets/pictures/plate-$criterion.png" --at 0.457 --size 480x300 --no-caption
done
say "rendering pile-press-fine"
cargo run --locked --quiet -- render pile-press-fine -o assets/pictures/pile-band.png --at 0.2155 --size 300x480 --no-caption
say "rendering pile-split"
cargo run --locked --quiet -- render pile-split -o assets/pictures/pile-split.png --at 0.16 --size 300x480 --no-caption
say "drawing the failure criteria"
cargo run --locked --quiet -- criteria -o assets/pictures/criteria.png
