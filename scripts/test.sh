#!/usr/bin/env bash
# Everything that must hold: format, lints, tests, known answers, documentation. Continuous integration runs this.
# On Debian and Ubuntu it installs what is missing by itself; elsewhere it names the packages.
# Arguments go to `cargo test`: `scripts/test.sh --lib fem` runs only those tests.
set -euo pipefail
# shellcheck source=scripts/lib.sh
source "$(dirname "${BASH_SOURCE[0]}")/lib.sh"

ensure_rust
ensure_linker
ensure_vulkan software
ensure_window
ensure_runtime_dir
for tool in fmt clippy; do
    cargo "$tool" --version >/dev/null 2>&1 \
        || fail "cargo $tool is missing: run \`rustup component add rustfmt clippy\`"
done

# One profile (dev) and the same flags throughout, so that every dependency is built once.
say "format"
cargo fmt --check
say "lints"
cargo clippy --locked --all-targets -- -D warnings
say "tests"
cargo test --locked --no-fail-fast "$@"
say "known answers"
cargo run --locked --quiet -- verify
say "pictures of the window"
scripts/pictures.sh check
say "documentation"
RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps
say "all is well"
