"""Packs the add-on as the zip file that Blender installs: the same bytes every time, with the version of Cargo.toml."""

import argparse
import re
import zipfile
from pathlib import Path

HERE = Path(__file__).parent
MANIFEST = "blender_manifest.toml"


def version():
    return re.search(r'^version = "(.*)"$', (HERE.parent / "Cargo.toml").read_text(encoding="utf-8"), re.MULTILINE)[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("output", type=Path, help="zip file to write")
    output = parser.parse_args().output
    output.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(output, "w") as packed:
        for file in sorted([*(HERE / "addon").glob("*.py"), HERE / "addon" / MANIFEST]):
            data = file.read_bytes()
            if file.name == MANIFEST:
                data = f'version = "{version()}"\n'.encode() + data
            packed.writestr(zipfile.ZipInfo(file.name), data, zipfile.ZIP_DEFLATED)


if __name__ == "__main__":
    main()
