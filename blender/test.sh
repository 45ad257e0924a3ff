#!/bin/sh
# Installs Blender, a Python package for Python 3.11, and tests the add-on in it: PYTHON VENV. TAOTIE names the program.
# Without the package, the tests are skipped with a reason; with CI=true only if Python is another version.
set -eu
python=$1
venv=$2
here=$(dirname "$0")

if ! "$python" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))'; then
    echo "skipped the tests of the add-on for Blender: bpy needs Python 3.11, not $("$python" --version)" >&2
    exit 0
fi
if ! test "$venv/ready" -nt "$here/requirements.txt"; then
    "$python" -m venv "$venv"
    if ! "$venv/bin/pip" install --quiet --requirement "$here/requirements.txt"; then
        echo "skipped the tests of the add-on for Blender: bpy could not be installed" >&2
        test "${CI:-}" != true
        exit
    fi
    touch "$venv/ready"
fi
exec "$venv/bin/python" -m pytest -c "$here/pytest.ini" "$here/test_taotie.py"
