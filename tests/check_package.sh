#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_package.sh: the packages that the build makes. The .deb holds what `cmake --install` installs, names the libraries that it
# needs, no link of its documents is dead, and lintian (if available) finds no error in it. Unpacked by `dpkg -x`, it runs the
# guide's first experiment, and a shipped experiment with its scenes and gnuplot scripts. The source archive holds the files of the
# commit, and builds say which it is. Uses $RT_PROGRAM. Skipped (77) without dpkg-dev, file, git or help2man, or outside a repository.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
cd "$(dirname "$0")/.."
source=$PWD build=$(dirname "$program")
for tool in dpkg-shlibdeps file git help2man; do
    command -v "$tool" >/dev/null || { echo "skipped: packages; needs dpkg-dev, file, git and help2man" && exit 77; }
done
git rev-parse --verify --quiet HEAD >/dev/null || { echo "skipped: packages; needs a repository" && exit 77; }

# made TARGET FILE: FILE, which the target makes
made() {
    cmake --build "$build" --target "$1" >"$work/log" 2>&1 && [ -s "$2" ] && return
    complain "the target $1 makes no ${2##*/}: $(tail -n 20 "$work/log")"
    conclude
}

# ---- the .deb ----
version=$("$program" --version | sed -n 's/^raytally //p')
deb=$build/raytally_$version-1_$(dpkg --print-architecture).deb
made deb "$deb"
dpkg -x "$deb" "$work/root"
cmake --install "$build" --prefix "$work/prefix" >/dev/null
(cd "$work/prefix" && find . ! -type d | sort) >"$work/installed"
(cd "$work/root/usr" && find . ! -type d | sed '/changelog\.Debian/d; s/\.gz$//; s/copyright$/LICENSE/' |
    sort) >"$work/packed"
diff "$work/installed" "$work/packed" >&2 || complain "the .deb does not hold what is installed"
for file in bin/raytally include/raytally/raytally.h share/man/man1/raytally-bench.1.gz share/doc/raytally/docs/guide/README.md \
    lib/python3/dist-packages/raytally.py share/doc/raytally/copyright share/raytally/experiments/first-look.yaml share/raytally/scenes/jewel.nff; do
    [ -s "$work/root/usr/$file" ] || complain "the .deb has no $file"
done
while read -r document; do check_links "$document"; done < <(find "$work/root" -name '*.md')
needs=$(dpkg-deb -f "$deb" Depends)
for library in libc6 libcairo2 libgmp10 libjansson4 libyaml-0-2 fonts-dejavu-core python3; do
    [[ $needs == *"$library"* ]] || complain "the .deb depends on $needs, not on $library"
done
if command -v lintian >/dev/null; then
    lintian --allow-root --fail-on error "$deb" >"$work/log" 2>&1 || complain "lintian: $(cat "$work/log")"
else
    echo "check_package: lintian is not installed: what it says of the .deb is not checked" >&2
fi

# ---- its use ----
export RT_PROGRAM=$work/root/usr/bin/raytally
said=$(tests/check_guide.sh docs/guide/first-experiment.md 2>&1) || complain "the guide's first experiment fails from the .deb: $said"
mkdir "$work/elsewhere"
shipped=$work/root/usr/share/raytally/experiments/papers/amanatides-woo-1987.yaml
(cd "$work/elsewhere" && timeout 300 "$RT_PROGRAM" run "$shipped" --quick --out out) >"$work/log" 2>&1 ||
    complain "a shipped experiment fails: $(tail -n 20 "$work/log")"
[ -z "$(command -v gnuplot)" ] || [ -s "$work/elsewhere/out/plots/1-dots.svg" ] || complain "a shipped experiment draws no plot"

if python=$(python_with_numpy); then
    said=$(PYTHONPATH=$work/root/usr/lib/python3/dist-packages "$python" -c 'import raytally; print(raytally._library._name)' 2>&1) || true
    [[ $said = "$work"/root/* ]] || complain "the Python module of the .deb: $said"
fi

# ---- the source archive ----
made package_source "$build/raytally-$version.tar.gz"
tar -xf "$build/raytally-$version.tar.gz" -C "$work"
diff <(git ls-tree -r --name-only HEAD | sort) <(cd "$work/raytally-$version" && find . ! -type d | cut -c 3- | sort) >&2 ||
    complain "the source archive does not hold the files of the commit"
cmake -DSOURCE="$work/raytally-$version" -DOUT="$work/info.h" -P "$source/cmake/build_info.cmake"
grep -q "RT_COMMIT \"$(git rev-parse --short=12 HEAD)\"" "$work/info.h" && grep -q 'RT_CLEAN false' "$work/info.h" ||
    complain "from the source archive: $(cat "$work/info.h")"
conclude
