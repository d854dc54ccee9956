#!/usr/bin/env bash
# Drops a ball (R = 3 mm) with OpenCAMLib and with Carvegraph: the same meshes, the same places, one
# after the other. Compares the heights and says what each location took.
#
#     tests/peers/opencamlib.sh DATA
#
# DATA is a folder with mount_rush.stl, spider.stl and a picture, astronaut.png; what is missing is left
# out. OpenCAMLib comes from PyPI into a folder that is gone at the end. Needs Python 3.7 to 3.11, for
# which it has wheels.
set -euo pipefail
data=$(realpath "${1:?the folder with the meshes}")
cd "$(dirname "$0")/../.."

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check opencamlib==2023.1.11 pillow

cargo build --release --quiet --package carvegraph-cli
cargo build --release --quiet --package carvegraph-geometry --example drop_on_stl
built=${CARGO_TARGET_DIR:-target}/release

# Reliefs of a picture, as meshes: 119 and 480 pixels across.
square='import sys; from PIL import Image
picture, side, square = sys.argv[1:]
Image.open(picture).convert("RGB").resize((int(side), int(side))).save(square)'
for side in 119 480; do
    [ -e "$data/astronaut.png" ] || break
    "$work/venv/bin/python" -c "$square" "$data/astronaut.png" "$side" "$work/relief$side.png"
    "$built/carve" run relief --quiet --only save_mesh --set "image=$work/relief$side.png" \
        --set save_mesh=binary --out "$work"
done

"$work/venv/bin/python" tests/peers/compare_drops.py "$built/examples/drop_on_stl" "$data" "$work"
