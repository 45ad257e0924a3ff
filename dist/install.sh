#!/bin/sh
# Installs the command `taotie`: downloads the release for this machine, checks its SHA-256, and unpacks program, man
# pages and completions.
#
#   curl -fsSL https://github.com/OWNER/taotie/releases/latest/download/install.sh | sh
#
# Environment:
#   TAOTIE_VERSION      the release, such as 0.1.0 (default: the latest)
#   TAOTIE_INSTALL_DIR  the folder of the program (default: ~/.local/bin); man pages and completions go to ../share if
#                       it is called `bin`, otherwise they are not installed
#   TAOTIE_TARGET       the target triple of the program (default: detected)
#   TAOTIE_DOWNLOADS    the address of a folder with SHA256SUMS and archives (default: that of the release)
set -eu

REPOSITORY=https://github.com/OWNER/taotie

fail() {
    printf 'install.sh: error: %s\n' "$1" >&2
    exit 1
}

say() {
    printf '%s\n' "$1" >&2
}

has() {
    command -v "$1" >/dev/null 2>&1
}

# Prints the target triple of this machine.
target() {
    processor=$(uname -m)
    # A shell that is translated by Rosetta reports the processor that it is translated for.
    if [ "$(sysctl -n sysctl.proc_translated 2>/dev/null || :)" = 1 ]; then processor=arm64; fi
    case $processor in
        x86_64 | amd64) processor=x86_64 ;;
        aarch64 | arm64) processor=aarch64 ;;
        *) fail "no release for the processor \`$processor\`: build from source, $REPOSITORY" ;;
    esac
    case $(uname -s) in
        Linux) printf '%s-unknown-linux-musl\n' "$processor" ;;
        Darwin) printf '%s-apple-darwin\n' "$processor" ;;
        MINGW* | MSYS* | CYGWIN*) fail 'on Windows, run install.ps1 in PowerShell' ;;
        *) fail "no release for the system \`$(uname -s)\`: build from source, $REPOSITORY" ;;
    esac
}

# Downloads the file at address $1 to $2.
download() {
    if has curl; then
        set -- "$1" "$2" --fail --silent --show-error --location --retry 3
        # No redirect may leave an encrypted connection.
        case $1 in https:*) set -- "$@" --proto '=https' --tlsv1.2 ;; esac
        address=$1 file=$2
        shift 2
        curl "$@" --output "$file" "$address" || fail "cannot download $address"
    elif has wget; then
        wget -q -O "$2" "$1" || fail "cannot download $1"
    else
        fail 'neither curl nor wget was found: install one of them'
    fi
}

# Prints the SHA-256 of the file $1.
sha256() {
    if has sha256sum; then
        sum=$(sha256sum <"$1")
    elif has shasum; then
        sum=$(shasum -a 256 <"$1")
    elif has openssl; then
        sum=$(openssl dgst -sha256 -r <"$1")
    else
        fail 'none of sha256sum, shasum and openssl was found: install one of them'
    fi
    printf '%s\n' "${sum%% *}"
}

# Prints the SHA-256 and the name of the archive for the target $2, from the list $1.
listed() {
    while read -r sum name; do
        name=${name#\*}
        case $name in
            taotie-*-"$2".tar.gz)
                printf '%s %s\n' "$sum" "$name"
                return
                ;;
        esac
    done <"$1"
    fail "the release has no archive for $2"
}

# Moves the file $1 to $2, at once: a running program keeps its file.
put() {
    if ! { mkdir -p "$(dirname "$2")" && cp "$1" "$2.new" && mv -f "$2.new" "$2"; }; then
        fail "cannot write $2: set TAOTIE_INSTALL_DIR to a folder that you may write to"
    fi
}

# Installs man pages and completions of the folder $1 below $2.
put_share() {
    for page in "$1"/man/*.1; do
        put "$page" "$2/man/man1/${page##*/}"
    done
    put "$1/completions/bash/taotie" "$2/bash-completion/completions/taotie"
    put "$1/completions/fish/taotie.fish" "$2/fish/vendor_completions.d/taotie.fish"
    put "$1/completions/zsh/_taotie" "$2/zsh/site-functions/_taotie"
}

# Prints what to add to the shell's settings, for the program's folder $1 and the folder of shared files $2.
hints() {
    case :$PATH: in
        *:"$1":*) ;;
        *)
            case ${SHELL:-} in
                */fish) say "To run it by name:  fish_add_path '$1'" ;;
                *) say "To run it by name, add to your shell's settings:  export PATH=\"$1:\$PATH\"" ;;
            esac
            ;;
    esac
    case ${SHELL:-} in
        */zsh) if [ -n "$2" ]; then say "For completions, add to ~/.zshrc before compinit:  fpath=('$2/zsh/site-functions' \$fpath)"; fi ;;
    esac
}

main() {
    for tool in tar gzip; do
        has "$tool" || fail "$tool was not found: install it"
    done
    target=${TAOTIE_TARGET:-$(target)}
    folder=${TAOTIE_INSTALL_DIR:-${HOME:?}/.local/bin}
    if [ -n "${TAOTIE_DOWNLOADS:-}" ]; then
        downloads=${TAOTIE_DOWNLOADS%/}
    elif [ -n "${TAOTIE_VERSION:-}" ]; then
        downloads=$REPOSITORY/releases/download/v${TAOTIE_VERSION#v}
    else
        downloads=$REPOSITORY/releases/latest/download
    fi
    place=$(mktemp -d)
    trap 'rm -rf "$place"' EXIT
    trap 'exit 130' INT TERM HUP

    download "$downloads/SHA256SUMS" "$place/SHA256SUMS"
    found=$(listed "$place/SHA256SUMS" "$target")
    archive=${found#* }
    say "downloading $downloads/$archive"
    download "$downloads/$archive" "$place/$archive"
    actual=$(sha256 "$place/$archive")
    if [ "$actual" != "${found%% *}" ]; then
        fail "$archive has SHA-256 $actual, but the release lists ${found%% *}: nothing was installed; try again later"
    fi
    gzip -dc "$place/$archive" | tar -xf - -C "$place" || fail "cannot unpack $archive"

    unpacked=$place/${archive%.tar.gz}
    share=
    put "$unpacked/taotie" "$folder/taotie"
    if [ "${folder##*/}" = bin ]; then
        share=${folder%/*}/share
        put_share "$unpacked" "$share"
    else
        say "no man pages or completions installed: $folder is not called \`bin\`"
    fi
    "$folder/taotie" --version >/dev/null || fail "$folder/taotie does not run on this machine: build from source, $REPOSITORY"
    say "installed $("$folder/taotie" --version) in $folder"
    hints "$folder" "$share"
}

# The last line, so that a script that was downloaded only in part does nothing.
main "$@"
