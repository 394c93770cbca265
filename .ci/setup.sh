# What ./run and ./test share: finds what is missing, and installs it or says what to type. Sourced, not run.
#
# Packages are installed by root, or by sudo where it asks for no password; Rust by rustup into the home
# folder. Each command is shown before it runs. On a terminal the user is asked first, unless CI=true.
# shellcheck shell=bash

# To stderr: what `tyndall` prints may be read by a program.
if [ -t 2 ]; then arrow=$'\033[1m==>\033[0m'; else arrow='==>'; fi
say() { printf '%s %s\n' "$arrow" "$*" >&2; }
fail() {
    printf 'error: %s\n' "$*" >&2
    exit 1
}
has() { command -v "$1" >/dev/null 2>&1; }

# Shows a command and runs it.
show_and_run() {
    printf '    %s\n' "$*" >&2
    "$@"
}

# Whether the user agrees; without a terminal, or in CI, silence is consent.
agree() {
    [ "${CI:-}" = true ] || [ ! -t 0 ] || {
        read -r -p "    $1 [Y/n] " answer
        case "$answer" in [nN]*) return 1 ;; esac
    }
}

# install_packages PACKAGE...
install_packages() {
    local as_root=()
    if ! has apt-get; then
        fail "no apt-get here: install the counterparts of '$*' with this system's own tool, then start again"
    fi
    if [ "$(id -u)" != 0 ]; then
        if has sudo && sudo -n true 2>/dev/null; then
            as_root=(sudo -n)
        else
            fail "only root may install packages; type: sudo apt-get update && sudo apt-get install $*"
        fi
    fi
    agree "install $*?" || fail "not installed; to do it later, type: apt-get update && apt-get install $*"
    show_and_run "${as_root[@]}" apt-get update -qq >&2
    show_and_run "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
        apt-get install -y -qq --no-install-recommends "$@" >&2
}

linker_works() {
    local folder result=0
    has cc || return 1
    folder="$(mktemp -d)"
    echo 'int main(void) { return 0; }' >"$folder/a.c"
    cc "$folder/a.c" -o "$folder/a" >/dev/null 2>&1 || result=1
    rm -r "$folder"
    return "$result"
}

rust_wanted() { sed -n 's/^rust-version = "\(.*\)"/\1/p' "$root/Cargo.toml"; }
rust_found() { { rustc --version 2>/dev/null || true; } | sed -n 's/^rustc \([0-9.]*\).*/\1/p'; }

# Whether version $1 is at least $2.
at_least() { [ "$(printf '%s\n%s\n' "$1" "$2" | sort -V | head -n 1)" = "$2" ]; }

rust_is_new_enough() { has cargo && has rustc && at_least "$(rust_found)" "$(rust_wanted)"; }

# By rustup, into the home folder.
install_rust() {
    local rustup="curl --proto '=https' --tlsv1.2 -sSf https://static.rust-lang.org/rustup/rustup-init.sh | sh -s -- -y"
    if has rustup; then
        agree "update Rust with rustup?" || fail "not updated; to do it later, type: rustup update stable"
        show_and_run rustup update stable
        rust_is_new_enough || export RUSTUP_TOOLCHAIN=stable
    else
        agree "install Rust with rustup into ${CARGO_HOME:-$HOME/.cargo}?" ||
            fail "not installed; to do it later, type: $rustup"
        printf '    %s\n' "$rustup" >&2
        # A Rust of the distribution may stay where it is; rustup's goes before it.
        RUSTUP_INIT_SKIP_PATH_CHECK=yes bash -o pipefail -c "$rustup" ||
            fail "rustup could not be installed; is the network reachable? See https://rustup.rs"
    fi
    rust_is_new_enough || fail "Rust $(rust_found) is still older than $(rust_wanted); type: rustup default stable"
}

# ensure_component COMMAND COMPONENT
ensure_component() {
    cargo "$1" --version >/dev/null 2>&1 && return
    say "missing: cargo $1"
    has rustup || fail "cargo $1 is not there; install it with the tool that installed Rust"
    show_and_run rustup component add "$2"
}

# A driver is a JSON file that the loader reads, and the loader a library of its own.
vulkan_works() {
    local file
    [ "$(uname)" = Linux ] || return 0
    if has ldconfig || [ -x /sbin/ldconfig ]; then
        # Not grep -q: it ends early, and pipefail would see ldconfig fail.
        PATH="$PATH:/sbin" ldconfig -p | grep 'libvulkan\.so\.1' >/dev/null || return 1
    fi
    [ -z "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] || return 0
    for file in /usr/share/vulkan/icd.d/*.json /usr/local/share/vulkan/icd.d/*.json \
        /etc/vulkan/icd.d/*.json "$HOME"/.local/share/vulkan/icd.d/*.json; do
        [ -e "$file" ] && return
    done
    return 1
}

has_display() { [ "$(uname)" != Linux ] || [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; }

# Libraries that a window on Linux loads when it opens, as Debian packages and the files that they are for.
window_packages() {
    local package
    [ "$(uname)" = Linux ] || return 0
    for package in libxcursor1:libXcursor.so.1 libxi6:libXi.so.6 libxkbcommon-x11-0:libxkbcommon-x11.so.0; do
        PATH="$PATH:/sbin" ldconfig -p | grep "${package#*:}" >/dev/null || printf '%s\n' "${package%%:*}"
    done
}

# The Vulkan loader wants a folder of the user's own.
ensure_runtime_dir() {
    [ -z "${XDG_RUNTIME_DIR:-}" ] || return 0
    XDG_RUNTIME_DIR="$(mktemp -d)"
    export XDG_RUNTIME_DIR
    trap 'rm -rf "$XDG_RUNTIME_DIR"' EXIT
}

# Names all that is missing before it installs any of it.
# set_up [window] [window_tests]
set_up() {
    local packages=() rust=found want package
    say "looking for a C linker, Rust $(rust_wanted) and a Vulkan driver"
    if ! linker_works; then
        [ "$(uname)" != Darwin ] || fail "no C linker; type: xcode-select --install"
        say "missing: a C linker"
        packages+=(gcc libc6-dev)
    fi
    # A fresh rustup is not yet in the PATH of the shell that started this.
    rust_is_new_enough || export PATH="${CARGO_HOME:-$HOME/.cargo}/bin:$PATH"
    if ! rust_is_new_enough; then
        rust="$(rust_found)"
        if [ -n "$rust" ]; then
            say "too old: Rust $rust, at least $(rust_wanted) is needed (rust-version in Cargo.toml)"
        else
            say "missing: Rust, at least $(rust_wanted)"
        fi
        has rustup || has curl || packages+=(curl ca-certificates)
    fi
    if ! vulkan_works; then
        say "missing: a Vulkan driver; Mesa's lavapipe needs no GPU"
        packages+=(mesa-vulkan-drivers)
    fi

    for want in "$@"; do
        for package in $(window_packages); do
            say "missing: $package, which the window loads"
            packages+=("$package")
        done
        [ "$want" = window_tests ] || continue
        has Xvfb || packages+=(xvfb)
        has xdotool || packages+=(xdotool)
    done

    [ "${#packages[@]}" = 0 ] || install_packages "${packages[@]}"
    [ "$rust" = found ] || install_rust
    linker_works || fail "cc cannot link a C program; see: echo 'int main(void){}' | cc -x c - -o a.out"
    vulkan_works ||
        fail "still no Vulkan: a driver is a file in /usr/share/vulkan/icd.d, the loader is libvulkan.so.1 (Debian: libvulkan1)"
    ensure_runtime_dir
    say "found: $(rustc --version)"
}
