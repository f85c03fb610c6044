#!/usr/bin/env bash
# Renders a scene to a GIF and says where it lies; no GPU, window or display is needed.
#   scripts/demo.sh [SCENE] [options of `hammerfall render`]
# On Debian and Ubuntu it installs what is missing by itself; elsewhere it names the packages.
set -euo pipefail
# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

scene="${1:-brick-pile}"
shift || true
output="out/$(basename "$scene" .toml).gif"

ensure_rust
ensure_linker
ensure_vulkan any
ensure_runtime_dir

say "building (the first time takes some minutes)"
cargo build --locked
mkdir -p out
say "rendering $scene"
cargo run --locked --quiet -- render "$scene" -o "$output" "$@"
say "the animation lies in $PWD/$output"
