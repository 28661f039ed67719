# shellcheck shell=bash
# Sourced by packaging/run, test and pin: a working .venv in the repository, on a bare machine too.
#
#   set_up run|dev     system packages, .venv, Stepfield in it; nothing to do takes some 20 ms
#   $root $venv        the repository and its environment

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)"
venv="$root/.venv"
unset PYTHONPATH PYTHONHOME # a sourced ROS workspace puts its own packages and pytest plugins in the way
unset PYTHONDONTWRITEBYTECODE # set in many containers; every one of the tests' processes would compile all it loads

# What the wheels expect of the system: package, what it brings (a shared library, "font" or a command), the dependency
# that needs it. A line counts once pyproject.toml names its dependency, those of "dev" for the tests only, those of
# "dev?" where the system has them: without, some tests are skipped and say so. The packages
# bring the rest themselves, software OpenGL included: libgl1 and libegl1 depend on Mesa's drivers.
system_packages=(
    "libexpat1 libexpat.so.1 rasterio"
    "libegl1 libEGL.so.1 open3d"
    "libgl1 libGL.so.1 open3d"
    "libidn2-0 libidn2.so.0 open3d"
    "libudev1 libudev.so.1 open3d"
    "libusb-1.0-0 libusb-1.0.so.0 open3d"
    "libx11-6 libX11.so.6 open3d"
    "libdbus-1-3 libdbus-1.so.3 PySide6-Essentials"
    "libfontconfig1 libfontconfig.so.1 PySide6-Essentials"
    "libglib2.0-0 libglib-2.0.so.0 PySide6-Essentials"
    "libxcb-cursor0 libxcb-cursor.so.0 PySide6-Essentials"
    "libxcb-icccm4 libxcb-icccm.so.4 PySide6-Essentials"
    "libxcb-image0 libxcb-image.so.0 PySide6-Essentials"
    "libxcb-keysyms1 libxcb-keysyms.so.1 PySide6-Essentials"
    "libxcb-randr0 libxcb-randr.so.0 PySide6-Essentials"
    "libxcb-render-util0 libxcb-render-util.so.0 PySide6-Essentials"
    "libxcb-shape0 libxcb-shape.so.0 PySide6-Essentials"
    "libxcb-sync1 libxcb-sync.so.1 PySide6-Essentials"
    "libxcb-xfixes0 libxcb-xfixes.so.0 PySide6-Essentials"
    "libxcb-xkb1 libxcb-xkb.so.1 PySide6-Essentials"
    "libxkbcommon-x11-0 libxkbcommon-x11.so.0 PySide6-Essentials"
    "fonts-dejavu-core font PySide6-Essentials"
    "xdotool xdotool dev"
    "xvfb Xvfb dev"
    "ignition-tools ign dev?"
    "libsdformat-dev libsdformat12.so.12 dev?"
)

say() { printf '%s\n' "$*" >&2; }

fail() {
    say "error: $*"
    exit 1
}

set_up() {
    local extras=$1
    is_current "$extras" && return
    [[ -w $root ]] || fail "this user cannot write to $root, where .venv belongs; use a copy that can be written"
    lock
    if is_current "$extras"; then
        unlock
        return
    fi
    local python
    python=$(usable_venv || find_python || true)
    install_missing_packages "$python" "$extras"
    [[ -n $python ]] || python=$(find_python) || fail "no Python 3.11 or newer was found after the packages were installed"
    usable_venv >/dev/null || make_venv "$python"
    install_stepfield "$extras"
    unlock
}

# --- Is there anything to do? -------------------------------------------------------------------------------------

is_current() {
    [[ -x $venv/bin/python && -r $venv/stepfield-stamp ]] || return 1
    local stamp
    stamp=$(<"$venv/stepfield-stamp")
    [[ $stamp == "dev $(fingerprint)" || $stamp == "$1 $(fingerprint)" ]]
}

# All that would make the installation stale: its place, its interpreter, what it was installed from.
fingerprint() {
    {
        printf '%s\n' "$root" "$(readlink -f "$venv/bin/python")"
        cat "$root/pyproject.toml" "$root/packaging/constraints.txt" "$root/packaging/setup.sh"
    } | checksum
}

checksum() { if command -v sha256sum >/dev/null; then sha256sum; else shasum -a 256; fi; }

# One set-up at a time.
lock() {
    command -v flock >/dev/null || return 0
    exec 9<"$root"
    flock --nonblock 9 || {
        say "Waiting for another set-up of $root to end."
        flock 9
    }
}

unlock() { exec 9<&-; }

# --- Python and the system's packages -----------------------------------------------------------------------------

is_new_enough() { "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; }

find_python() {
    local name
    for name in "${PYTHON:-python3}" python3.14 python3.13 python3.12 python3.11; do
        if is_new_enough "$name"; then
            command -v "$name"
            return
        fi
    done
    return 1
}

install_missing_packages() {
    local python=$1 extras=$2 packages
    packages=$(missing_packages "$python" "$extras")
    [[ -n $packages ]] || return 0
    command -v apt-get >/dev/null ||
        fail "this system has no apt-get to install what is missing; install what these Debian packages hold: $packages"
    local -a privilege=()
    if ((EUID != 0)); then
        if command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [[ -t 0 && -t 2 ]]; }; then
            privilege=(sudo)
        else
            refuse_old_system "$python"
            fail "system packages are missing; have an administrator run: apt-get install --no-install-recommends $packages"
        fi
    fi
    "${privilege[@]}" apt-get update -qq >/dev/null 2>&1 || true # what matters is whether the packages then install
    refuse_old_system "$python"
    packages=$(missing_packages "$python" "$extras") # anew: a bare system knows its Python only now
    say "Installing system packages: $packages"
    local output
    # shellcheck disable=SC2086 # a list of names
    output=$("${privilege[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 \
        install -y -qq --no-install-recommends $packages 2>&1) || {
        say "$(grep -E '^(E|W):' <<<"$output" | tail -n 5)"
        fail "apt-get could not install them (no network?); once this works, run again: apt-get install --no-install-recommends $packages"
    }
}

# The names of the missing packages on one line; empty when nothing is missing.
missing_packages() {
    { missing_python "$1" && missing_for_wheels "$2"; } | paste -s -d ' ' -
}

missing_python() {
    if [[ -z $1 ]]; then
        python_packages || true
    elif ! "$1" -c 'import ensurepip, venv' 2>/dev/null; then
        [[ $1 == /usr/bin/* || $1 == /bin/* ]] ||
            fail "$1 cannot make virtual environments (its ensurepip is missing); name another one: PYTHON=/path/to/python3"
        echo "$(basename "$1")-venv"
    fi
}

# The default Python where it is new enough, else the newest one there is beside it; fails when apt knows of none.
python_packages() {
    local name version
    for name in python3 python3.13 python3.12 python3.11; do
        version=$(candidate "$name")
        if [[ -n $version ]] && dpkg --compare-versions "$version" ge 3.11; then
            printf '%s\n' "$name" "$name-venv"
            return
        fi
    done
    printf '%s\n' python3 python3-venv
    return 1
}

candidate() { LC_ALL=C apt-cache policy "$1" 2>/dev/null | sed -n 's/^ *Candidate: *\([0-9].*\)/\1/p'; }

# $1 is the Python found. A bare system knows of no packages at all before its first apt-get update.
refuse_old_system() {
    [[ -n $1 || -z $(candidate python3) ]] || python_packages >/dev/null ||
        fail "Stepfield needs Python 3.11 or newer, and this system's newest is $(candidate python3); name another one: PYTHON=/path/to/python3"
}

missing_for_wheels() {
    [[ $(uname) == Linux ]] || return 0
    local extras=$1 package brings dependency libraries
    libraries=$(PATH="$PATH:/sbin:/usr/sbin" ldconfig -p 2>/dev/null) || return 0
    while read -r package brings dependency; do
        if [[ $dependency == "dev?" ]]; then
            [[ $extras == dev && -n $(candidate "$package") ]] || continue
        else
            [[ $dependency == "$extras" ]] || is_dependency "$dependency" || continue
        fi
        is_there "$brings" "$libraries" || echo "$package"
    done < <(printf '%s\n' "${system_packages[@]}")
}

# Whether the system has what a package brings; $2 are the shared libraries it knows.
is_there() {
    case $1 in
    font) has_font ;;
    *.so.*) [[ $2 == *"$1"* ]] ;;
    *) command -v "$1" >/dev/null ;;
    esac
}

# Whether there is a font to write with: fontconfig alone may bring one for code only, as Debian 13 does.
has_font() {
    local -a folders=(/usr/share/fonts /usr/local/share/fonts "${HOME:-/}/.local/share/fonts" "${HOME:-/}/.fonts")
    [[ -n $(find -L "${folders[@]}" \( -iname '*.ttf' -o -iname '*.otf' -o -iname '*.ttc' \) ! -iname '*mono*' \
        -print -quit 2>/dev/null) ]]
}

is_dependency() { grep -Eq "^ *\"$1(-cpu)?[ ;<>=~!]" "$root/pyproject.toml"; }

# --- The environment and Stepfield in it --------------------------------------------------------------------------

# The environment's Python, if it was made for this place and still works.
usable_venv() {
    local python="$venv/bin/python"
    [[ -x $python ]] && is_new_enough "$python" || return 1
    [[ $("$python" -m pip --version 2>/dev/null) == *" from $venv/"* ]] || return 1
    [[ ! -r $venv/stepfield-root || $(<"$venv/stepfield-root") == "$root" ]] || return 1
    echo "$python"
}

make_venv() {
    say "Making .venv with $("$1" --version)."
    local output
    output=$("$1" -m venv --clear "$venv" 2>&1) || explain "the environment could not be made" "$output"
    echo "$root" >"$venv/stepfield-root" || fail "the environment could not be written"
}

install_stepfield() {
    local extras=$1 output
    if grep -qs '^dev ' "$venv/stepfield-stamp"; then extras=dev; fi # keep what is there
    local -a install=(-m pip install --disable-pip-version-check --no-input -c packaging/constraints.txt)
    if [[ ! -t 2 ]]; then install+=(--quiet); fi
    if [[ $extras == dev ]]; then install+=(--editable ".[dev]"); else install+=(--editable .); fi
    say "Installing Stepfield and its libraries; the first time takes a minute or two."
    # The variables, relative for the sake of blanks in $root, pin what builds the package as well.
    {
        output=$(cd "$root" && PIP_CONSTRAINT=packaging/constraints.txt PIP_BUILD_CONSTRAINT=packaging/constraints.txt \
            "$venv/bin/python" "${install[@]}" 2>&1 >&3)
    } 3>&2 || explain "pip could not install Stepfield" "$output"
    echo "$extras $(fingerprint)" >"$venv/stepfield-stamp" || fail "the environment could not be written"
}

# One sentence for the failures that are nobody's bug; for the others also what the tool said.
explain() {
    local what=$1 output=$2
    if (($(df -Pk "$root" | awk 'NR == 2 { print $4 }') < 100000)); then output="No space left"; fi # ensurepip hides it
    case $output in
    *"No space left"* | *"Errno 28]"* | *"quota exceeded"*)
        fail "$what: the disk is full; Stepfield's libraries need about 2 GB in $venv and some in ${TMPDIR:-/tmp}" ;;
    *"Read-only file system"* | *"Permission denied"* | *"Errno 13]"* | *"Errno 30]"*)
        fail "$what: this user cannot write to $venv; remove it or use a copy of your own" ;;
    *"NewConnectionError"* | *"NameResolutionError"* | *"name resolution"* | *"Network is unreachable"* | \
        *"ProxyError"* | *"timed out"* | *"Connection refused"* | *"SSLError"*)
        fail "$what: the package index does not answer; check the network and pip's proxy and index settings, then run again" ;;
    esac
    say "$(tail -n 15 <<<"$output")"
    fail "$what; the lines above say why"
}
