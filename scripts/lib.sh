# shellcheck shell=bash
# Shared by the scripts: finding out what the machine has, and installing what it lacks.
# Source it; it changes to the root of the repository.

cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1

# Packages for drawing without a GPU, by system. They bring the Vulkan loader along.
readonly VULKAN_DEBIAN="mesa-vulkan-drivers libvulkan1"
readonly VULKAN_FEDORA="mesa-vulkan-drivers vulkan-loader"
readonly VULKAN_ARCH="vulkan-swrast vulkan-icd-loader"
# Packages for the test that opens a window on a virtual display.
readonly WINDOW_DEBIAN="xvfb libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon0 libxkbcommon-x11-0 libxrandr2"
readonly WINDOW_FEDORA="xorg-x11-server-Xvfb libX11 libX11-xcb libXcursor libXi libxkbcommon libxkbcommon-x11 libXrandr"
readonly WINDOW_ARCH="xorg-server-xvfb libx11 libxcursor libxi libxkbcommon libxkbcommon-x11 libxrandr"
# Where packages are unpacked that may not be installed.
readonly UNPACKED="$PWD/target/unpacked-packages"

say() { printf '== %s\n' "$*" >&2; }
fail() {
    printf 'error: %s\n' "$*" >&2
    exit 1
}
have() { command -v "$1" >/dev/null 2>&1; }

# debian, fedora, arch, macos, windows or other
system() {
    case "$(uname -s)" in
        Darwin) echo macos ;;
        MINGW* | MSYS* | CYGWIN*) echo windows ;;
        *) linux_family ;;
    esac
}

linux_family() {
    local ids=""
    if [ -r /etc/os-release ]; then
        # shellcheck disable=SC1091
        ids="$(. /etc/os-release && echo " ${ID:-} ${ID_LIKE:-} ")"
    fi
    case "$ids" in
        *" debian "* | *" ubuntu "*) echo debian ;;
        *" fedora "* | *" rhel "*) echo fedora ;;
        *" arch "*) echo arch ;;
        *) echo other ;;
    esac
}

# Runs a command as root, asking for a password only where somebody can type it.
# Status 126: there is no way to become root.
as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif have sudo && sudo -n true 2>/dev/null; then
        sudo -n "$@"
    elif have sudo && [ -t 0 ]; then
        sudo "$@"
    else
        return 126
    fi
}

debian_missing() {
    local package
    for package in "$@"; do
        dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || echo "$package"
    done
}

# Installs Debian packages that are not there yet. Status 126: no way to become root.
debian_install() {
    local -a missing
    mapfile -t missing < <(debian_missing "$@")
    [ "${#missing[@]}" -eq 0 ] && return 0
    say "missing here: ${missing[*]}"
    as_root true || return 126
    say "installing them"
    # Fails when one of several sources is down; what matters is whether the install succeeds.
    as_root apt-get update -qq || say "the package lists could not all be refreshed; going on"
    as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
}

# Says what to install on a system where this script does not do it.
name_packages() {
    local purpose="$1" fedora="$2" arch="$3" debian="$4"
    case "$(system)" in
        fedora) say "$purpose needs: sudo dnf install $fedora" ;;
        arch) say "$purpose needs: sudo pacman -S --needed $arch" ;;
        *) say "$purpose needs what Debian calls: $debian" ;;
    esac
}

ensure_rust() {
    local wanted found
    if ! have cargo && [ -r "$HOME/.cargo/env" ]; then
        # shellcheck disable=SC1091
        . "$HOME/.cargo/env"
    fi
    have cargo || fail "Rust is missing: install it from https://rustup.rs and run this again"
    wanted="$(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml)"
    found="$(rustc --version | cut -d' ' -f2)"
    if [ "$(printf '%s\n%s\n' "$wanted" "$found" | sort -V | head -n 1)" != "$wanted" ]; then
        fail "Rust $wanted or newer is needed, this is $found: run \`rustup update stable\` (https://rustup.rs)"
    fi
}

# Rust links with the system's C compiler.
ensure_linker() {
    have cc && return 0
    case "$(system)" in
        debian) debian_install gcc libc6-dev || fail "a linker is missing: run \`apt-get install gcc libc6-dev\` as root" ;;
        macos) fail "a linker is missing: run \`xcode-select --install\`" ;;
        windows) ;; # The MSVC tools are no `cc`; rustup has seen to them.
        *) fail "a linker is missing: install gcc" ;;
    esac
}

# The driver manifests that the Vulkan loader would read.
vulkan_manifests() {
    local folder
    tr ':' '\n' <<<"${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}"
    for folder in /usr/share /usr/local/share /etc "${XDG_DATA_HOME:-$HOME/.local/share}"; do
        find "$folder/vulkan/icd.d" -name '*.json' 2>/dev/null || true
    done
}

has_vulkan_driver() { vulkan_manifests | grep -q .; }
has_software_vulkan() { vulkan_manifests | grep -q 'lvp_icd'; }

# ensure_vulkan any: whatever driver there is will do. ensure_vulkan software: the same pixels everywhere.
ensure_vulkan() {
    case "$(system)" in
        macos | windows) return 0 ;; # Metal and Direct3D come with the system.
    esac
    if [ "$1" = any ] && has_vulkan_driver; then return 0; fi
    if has_software_vulkan; then return 0; fi
    if [ "$(system)" != debian ]; then
        name_packages "drawing without a GPU" "$VULKAN_FEDORA" "$VULKAN_ARCH" "$VULKAN_DEBIAN"
        fail "there is no Vulkan driver"
    fi
    say "there is no Vulkan driver yet: a software one will do"
    # shellcheck disable=SC2086  # a list of packages
    debian_install $VULKAN_DEBIAN || unpack_vulkan \
        || fail "no Vulkan driver: run \`apt-get install $VULKAN_DEBIAN\` as root, then this again"
}

# For somebody who may not install: unpacks the driver below target/ and points the loader at it.
unpack_vulkan() {
    local manifests="$UNPACKED/icd.d" libraries
    if [ ! -e "$manifests/lvp_icd.json" ]; then
        say "no right to install: unpacking the driver into $UNPACKED"
        # shellcheck disable=SC2086  # a list of packages
        debian_unpack $VULKAN_DEBIAN || return 1
    fi
    libraries="$(find "$UNPACKED" -name 'libvulkan_lvp.so' -printf '%h\n' -quit)"
    [ -n "$libraries" ] || return 1
    mkdir -p "$manifests"
    sed "s|\"library_path\": *\".*\"|\"library_path\": \"$libraries/libvulkan_lvp.so\"|" \
        "$UNPACKED"/usr/share/vulkan/icd.d/lvp_icd*.json >"$manifests/lvp_icd.json"
    export VK_DRIVER_FILES="$manifests/lvp_icd.json" VK_ICD_FILENAMES="$manifests/lvp_icd.json"
    export LD_LIBRARY_PATH="$libraries${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
}

# Downloads packages with all they lack here, and unpacks them without installing.
debian_unpack() {
    local -a names
    mapfile -t names < <(
        apt-get -o Debug::NoLocking=1 --print-uris -qq -y --no-install-recommends install "$@" 2>/dev/null \
            | sed -n "s/^'[^']*' \([^_]*\)_.*/\1/p"
    )
    [ "${#names[@]}" -gt 0 ] || return 1
    mkdir -p "$UNPACKED/debs"
    (cd "$UNPACKED/debs" && apt-get download -qq "${names[@]}") >&2 || return 1
    find "$UNPACKED/debs" -name '*.deb' -exec dpkg-deb -x {} "$UNPACKED" \;
}

# A virtual display and the libraries that a window loads. Only one test needs them, and that test
# says so itself: whoever may not install can still run all the others.
ensure_window() {
    case "$(system)" in
        macos | windows) return 0 ;;
        debian)
            # shellcheck disable=SC2086  # a list of packages
            debian_install $WINDOW_DEBIAN \
                || say "the window test cannot run: \`apt-get install $WINDOW_DEBIAN\` as root makes it possible"
            ;;
        *)
            have Xvfb && return 0
            name_packages "the window test" "$WINDOW_FEDORA" "$WINDOW_ARCH" "$WINDOW_DEBIAN"
            ;;
    esac
}

# Drivers and windows want a private folder for sockets; a bare container has none.
ensure_runtime_dir() {
    [ -n "${XDG_RUNTIME_DIR:-}" ] && return 0
    XDG_RUNTIME_DIR="$(mktemp -d)"
    export XDG_RUNTIME_DIR
    chmod 700 "$XDG_RUNTIME_DIR"
    trap 'rm -rf "$XDG_RUNTIME_DIR"' EXIT
}
