#!/bin/sh
# Creates the environment of the part `render` of `make bench`: install.sh PYTHON FOLDER. The peer that counts, llvmpipe, must install;
# others that fail to install are reported and skipped. System packages are not installed; in Debian, these are
# libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri (llvmpipe, VTK, F3D), mesa-vulkan-drivers libvulkan1 (wgpu, Open3D),
# libosmesa6 (pyrender), libllvm19 (Mitsuba), chromium nodejs npm (three.js).
set -e
python=$1 folder=$2 here=$(dirname "$0")
"$python" -m venv "$folder"
"$folder/bin/pip" install --quiet --requirement "$here/requirements.txt"

add() { "$folder/bin/pip" install --quiet "$@" || echo "skipped, cannot be installed: $1" >&2; }
add vtk==9.7.2
add mitsuba==3.9.1
add wgpu==0.32.0
add f3d==4.0.0
add open3d==0.20.0
add pyrender==0.1.45
# pyrender requires 3.1.0, which has no OSMesa contexts with attributes.
add --no-deps PyOpenGL==3.1.10

npm=$(dirname "$folder")/node
mkdir -p "$npm"
npm install --prefix "$npm" --no-audit --no-fund --silent three@0.187.0 playwright-core@1.65.1 ||
    echo "skipped, cannot be installed: three.js" >&2
