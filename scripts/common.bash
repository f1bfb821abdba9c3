# What scripts/raymill and scripts/test share: Debian's packages, and an up-to-date build. For bash, to be sourced.
# Messages go to standard error: standard output belongs to the program.
: "${root:?is the root of the checkout, set by who sources this}"

say() { printf 'raymill: %s\n' "$*" >&2; }

# fail LOG MESSAGE: shows the end of the log and stops.
fail() {
    tail -n 40 "$1" >&2
    say "$2; the whole log is $1"
    exit 1
}

# Held until release_lock, so that of several scripts started at once only one installs and builds.
take_lock() {
    if ! mkdir -p "$root/build" 2>/dev/null || [[ ! -w $root/build ]]; then
        say "nothing can be built in $root/build: change its permissions, or use a copy of the checkout that is yours"
        exit 1
    fi
    exec {lock}>"$root/build/.lock"
    flock --nonblock "$lock" && return
    say 'waiting for another script that installs or builds here'
    flock "$lock"
}

release_lock() { exec {lock}>&-; }

# listed_packages LIST...: names only, one a line.
listed_packages() { (cd "$root/scripts/packages" && sed -E 's/#.*//; s/[[:space:]]+//g; /^$/d' "${@/%/.txt}"); }

# missing_packages PACKAGE...: those that are not installed, one a line.
missing_packages() {
    local installed package
    # dpkg-query fails where it does not know a package, after naming those that it knows.
    installed=$(dpkg-query --show --showformat '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null) || true
    for package; do
        [[ $'\n'$installed$'\n' == *$'\n'"installed $package"$'\n'* ]] || printf '%s\n' "$package"
    done
}

# Prints how to become root, if only by asking for a password; fails where there is no way.
root_command() {
    if [[ $EUID == 0 ]]; then
        printf 'env'
    elif ! command -v sudo >/dev/null; then
        return 1
    elif sudo -n true 2>/dev/null; then
        printf 'sudo -n env'
    elif [[ -t 0 && -t 2 ]] && say 'installing packages needs the rights of root' && sudo -v; then
        printf 'sudo env'
    else
        return 1
    fi
}

# install_packages LIST...: makes sure that all packages of the lists are installed. A stamp says that they are, until a
# list or the system's packages change or a build fails.
install_packages() {
    local stamp="$root/build/.installed-${*: -1}" log="$root/build/packages.log" become
    local -a packages missing
    packages_unchanged "$stamp" "$@" && return
    mapfile -t packages < <(listed_packages "$@")
    if ! command -v dpkg-query >/dev/null; then
        say "this is not Debian: see that it has what these packages of Debian hold: ${packages[*]}"
    else
        mapfile -t missing < <(missing_packages "${packages[@]}")
        if ((${#missing[@]})); then
            become=$(root_command) || refuse_to_install "${missing[@]}"
            say "installing ${missing[*]}"
            apt_install "$become" "${missing[@]}" >"$log" 2>&1 </dev/null ||
                fail "$log" 'the packages could not be installed'
        fi
    fi
    : >"$stamp"
}

# packages_unchanged STAMP LIST...: nothing happened since the stamp was made.
packages_unchanged() {
    local stamp=$1 list
    [[ -f $stamp && ! /var/lib/dpkg/status -nt $stamp ]] || return
    for list in "${@:2}"; do
        [[ $stamp -nt $root/scripts/packages/$list.txt ]] || return
    done
}

refuse_to_install() {
    local as_root=''
    command -v sudo >/dev/null && as_root='sudo '
    say "these packages are missing, and installing them needs the rights of root: $*"
    say "run, or have an administrator run:"
    say "  ${as_root}apt-get update && ${as_root}apt-get install --no-install-recommends $*"
    exit 1
}

# apt_install BECOME PACKAGE...: the lists of packages are fetched only if it does not work without: they may be absent
# or so old that they name files which are gone.
apt_install() {
    local become=$1
    local -a apt=(DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=600)
    shift
    # shellcheck disable=SC2086  # become is a command of several words
    $become "${apt[@]}" install --yes --no-install-recommends "$@" ||
        { $become "${apt[@]}" update && $become "${apt[@]}" install --yes --no-install-recommends "$@"; }
}

# configure PRESET: afresh if it was never done, for another place, or with other presets.
configure() {
    local folder="$root/build/$1" log="$root/build/$1.log"
    local stamp="$folder/.configured"
    [[ -f $stamp && $(<"$stamp") == "$root" && ! $root/CMakePresets.json -nt $stamp ]] && return
    say "configuring build/$1"
    (cd "$root" && cmake --fresh --preset "$1") >"$log" 2>&1 </dev/null || return
    printf '%s\n' "$root" >"$stamp"
}

# ninja_build PRESET TARGET...: says so only if there is something to build; a terminal sees how far it is.
ninja_build() {
    local folder="$root/build/$1" log="$root/build/$1.log" line said=''
    shift
    ninja -C "$folder" ${CMAKE_BUILD_PARALLEL_LEVEL:+-j "$CMAKE_BUILD_PARALLEL_LEVEL"} "$@" 2>&1 </dev/null | {
        while IFS= read -r line; do
            printf '%s\n' "$line"
            [[ $line == '['[1-9]* ]] || continue  # [0/...]: only looking
            [[ $said ]] || say "building (log: $log)"
            said=yes
            [[ -t 2 ]] && printf '\r%s] ' "${line%%]*}" >&2
        done >"$log"
        [[ $said && -t 2 ]] && printf '\r\e[K' >&2
    }
    return "${PIPESTATUS[0]}"
}

# ensure_build PRESET TARGET...: configures and builds what is not up to date.
ensure_build() {
    if ! configure "$1" || ! ninja_build "$@"; then
        rm -f "$root"/build/.installed-*  # the folder may come from another machine: look at the packages next time
        fail "$root/build/$1.log" 'the build failed'
    fi
}
