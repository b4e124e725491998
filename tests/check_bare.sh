#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_bare.sh FOLDER [bookworm|trixie...]: by hand, as root, with debootstrap, git and a network; it takes an hour or more. For Debian
# 12 and 13, or those named: makes the minimal system FOLDER/SYSTEM, which must not exist, unpacks the commit there, and runs
# `./run.sh --quick` and `./test.sh $TEST_OPTIONS`. Then it makes the .deb, installs it in another minimal system,
# FOLDER/SYSTEM-package, and runs the guide's first experiment there. FOLDER/SYSTEM.log has all output. The settings of the network and of
# apt are this machine's; $MIRROR: another mirror. Exit code 1 if anything failed.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] && [ "$(id -u)" = 0 ] || { echo "usage: tests/check_bare.sh FOLDER [bookworm|trixie...], as root" >&2 && exit 2; }
mkdir -p "$1" && folder=$(realpath "$1") && shift
[ $# -gt 0 ] || set -- bookworm trixie
commit=$(git rev-parse --short=12 HEAD)

# inside ROOT COMMAND: in the tree of that system, with mounts that end with the command
inside() {
    # shellcheck disable=SC2016 # expanded inside
    unshare --mount --propagation private bash -c '
        mount -t proc proc "$0/proc" && mount --rbind /sys "$0/sys" && mount --rbind /dev "$0/dev" &&
            exec env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 http_proxy="${http_proxy-}" \
                https_proxy="${https_proxy-}" chroot "$0" bash -c "cd /root/raytally && $1"' "$1" "$2"
}

# minimal SYSTEM ROOT: a new system, with the tree
minimal() {
    debootstrap --variant=minbase --include=ca-certificates "$1" "$2" ${MIRROR:+"$MIRROR"} &&
        cp /etc/resolv.conf /etc/hosts "$2/etc/" && cp -r /etc/apt/apt.conf.d "$2/etc/apt/" && mkdir "$2/root/raytally" &&
        git archive "$commit" | tar -x -C "$2/root/raytally"
}

# check SYSTEM: joined by &&, since `if` turns -e off
check() {
    local root=$folder/$1
    minimal "$1" "$root" &&
        inside "$root" './run.sh --quick' &&
        inside "$root" "build/release/raytally --version | tee /dev/stderr | grep -q '^commit: $commit'" &&
        inside "$root" "./test.sh ${TEST_OPTIONS-}" &&
        inside "$root" 'source ./setup.sh && install_missing package && cmake --preset release &&
            cmake --build build/release --target deb' &&
        minimal "$1" "$root-package" &&
        cp "$root"/root/raytally/build/release/raytally_*.deb "$root-package/root/" &&
        inside "$root-package" 'apt-get update && apt-get install -y /root/raytally_*.deb &&
            RT_PROGRAM=/usr/bin/raytally tests/check_guide.sh docs/guide/first-experiment.md'
}

failed=0
for system; do
    [ ! -e "$folder/$system" ] && [ ! -e "$folder/$system-package" ] ||
        { echo "$folder/$system or $folder/$system-package exists: remove it first" >&2 && exit 2; }
    echo "== $system, commit $commit: $folder/$system.log"
    if check "$system" >"$folder/$system.log" 2>&1 </dev/null; then
        echo "== $system: passed: $(grep -a ' passed, ' "$folder/$system.log" | tail -n 1)"
    else
        echo "== $system: failed" && tail -n 20 "$folder/$system.log"
        failed=1
    fi
done
exit $failed
