#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_python.sh: python/raytally.py with the library beside $RT_PROGRAM: tests/python. Skipped (77) without python3 or NumPy.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
tree=$(realpath "$(dirname "$0")/..") build=$(dirname "$program")
python=$(python_with_numpy) || { echo 'skipped: the Python module; needs python3-numpy' && exit 77; }
export RT_PROGRAM=$program RT_PLUGINS=$build/plugins RAYTALLY_LIBRARY=$build/libraytally.so PYTHONPATH=$tree/python PYTHONDONTWRITEBYTECODE=1
cd "$work"
"$python" "$tree/tests/python/test_raytally.py" || complain "the Python module does not pass its tests"
conclude
