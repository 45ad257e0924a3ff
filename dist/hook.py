#!/usr/bin/env python3
"""Hook of pre-commit: checks glTF assets with `taotie inspect`.

Fails for a file that cannot be read, that names missing files, that has warnings, or, with `--audit SCHEMA`, that fails
a check of the schema (docs/audit.md). Options of `taotie inspect` are passed on.
"""

from __future__ import annotations

import json
import subprocess
import sys

MODELS = (".fbx", ".glb", ".gltf", ".obj", ".ply", ".stl")


def main(arguments: list[str]) -> int:
    """Check the files at the end of the arguments; return the exit code of the hook."""
    # pre-commit puts the files last.
    count = next((at for at, argument in enumerate(reversed(arguments)) if not argument.lower().endswith(MODELS)), len(arguments))
    options, files = arguments[: len(arguments) - count], arguments[len(arguments) - count :]
    try:
        return max((check(options, file) for file in files), default=0)
    except FileNotFoundError:
        print("taotie was not found: install it and add its folder to PATH", file=sys.stderr)
        return 1


def check(options: list[str], file: str) -> int:
    """Print what is wrong with a file; return 1 if anything is."""
    command = ["taotie", "inspect", "--json", *options, "--", file]
    done = subprocess.run(command, capture_output=True, text=True, encoding="utf-8", errors="backslashreplace", check=False)
    if done.returncode > 1 or not done.stdout:
        print(done.stderr.strip() or f"{file}: taotie ended with exit code {done.returncode}")
        return 1
    found = faults(json.loads(done.stdout))
    for fault in found:
        print(f"{file}: {fault}")
    return int(bool(found) or done.returncode != 0)


def faults(report: dict) -> list[str]:
    """Return the faults in a report of `taotie inspect`."""
    checks = report.get("checks", [])
    failed = [f"{check['name']}: {check['message']}" for check in checks if check["status"] == "fail"]
    warnings = [f"{warning['count']}× {warning['what']}" for warning in report.get("warnings", [])]
    return failed + warnings


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
