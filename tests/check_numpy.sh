#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Rays and hits as NumPy arrays: raytally reads NumPy's files correctly, and NumPy raytally's. Uses $RT_PROGRAM.
# Skipped (77) without python3 or NumPy.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
python=$(python_with_numpy) || { echo 'skipped: files of rays by NumPy; needs python3-numpy' && exit 77; }
mkdir "$work/bin" && ln -s "$program" "$work/bin/raytally"
printf '#!/bin/sh\nexec "%s" "$@"\n' "$python" >"$work/bin/python3" && chmod +x "$work/bin/python3"
export PATH=$work/bin:$PATH
cd "$work"

fail() {
    echo "check_numpy: $*" >&2
    exit 1
}

# Through NumPy and back: the same hits. Other orders and types: refused.
raytally rays balls:size=2 --size 64x64 --rays diffuse -o rays.npy >said
raytally bench balls:size=2 --size 64x64 --rays diffuse --accel grid --count-only --json --hits h1.npy >one.json
python3 - <<'EOF'
import numpy
rays = numpy.load("rays.npy")
assert rays.dtype == numpy.float32 and rays.shape[1] == 8
numpy.save("copy.npy", rays)
numpy.save("double.npy", rays.astype("float64"))
numpy.save("big.npy", rays.astype(">f4"))
numpy.save("columns.npy", numpy.asfortranarray(rays))
numpy.save("flat.npy", rays.ravel())
with open("version2.npy", "wb") as file:
    numpy.lib.format.write_array(file, rays, version=(2, 0))
with open("version3.npy", "wb") as file:
    numpy.lib.format.write_array(file, rays, version=(3, 0))
EOF
given='bench balls:size=2 --rays nearest --accel grid --count-only --rays-from'
for file in copy version2 version3; do
    raytally $given $file.npy --hits h2.npy >said
    cmp h1.npy h2.npy || fail "the rays of $file.npy are others"
done
for file in double.npy big.npy columns.npy flat.npy; do
    code=0
    raytally $given $file >said 2>why || code=$?
    [ $code = 2 ] && grep -q "^raytally: $file: " why || fail "$file is not refused: $(cat why)"
done
python3 - <<'EOF'
import json, numpy
hits, table = numpy.load("h1.npy"), json.load(open("one.json"))["rows"][0]["counts"]
met = hits["object"] >= 0
assert met.sum() == table["hits"] and numpy.isfinite(hits["t"][met]).all() and numpy.isinf(hits["t"][~met]).all()
EOF

# As text: the same numbers.
raytally rays balls:size=2 --size 64x64 --rays diffuse -o rays.csv >said
raytally $given rays.csv --hits h.csv >said
python3 - <<'EOF'
import numpy
assert (numpy.loadtxt("rays.csv", dtype="float32", delimiter=",", skiprows=1) == numpy.load("rays.npy")).all()
hits = numpy.load("h1.npy")
assert (numpy.genfromtxt("h.csv", delimiter=",", names=True, dtype=hits.dtype) == hits).all()
numpy.savetxt("h.csv", hits["t"], header="t", comments="")
EOF
raytally verify balls:size=2 --rays-from rays.csv --hits-from h.csv >said || fail "t as text is judged: $(cat said)"
