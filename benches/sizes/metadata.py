"""The size of a GLB without its metadata: `extras`, and XMP in KHR_xmp_json_ld."""

import json
import os
import struct

XMP = "KHR_xmp_json_ld"


def bytes_without(path):
    """The file's size minus the bytes that metadata adds to its JSON."""
    gltf = read_json(path)
    return os.path.getsize(path) - (length(gltf) - length(stripped(gltf)))


def read_json(path):
    with open(path, "rb") as file:
        head = file.read(20)
        return json.loads(file.read(struct.unpack_from("<I", head, 12)[0]))


def length(gltf):
    return len(json.dumps(gltf, separators=(",", ":"), ensure_ascii=False).encode())


def stripped(value):
    """The JSON without metadata, and without objects and lists that become empty."""
    if isinstance(value, list):
        return [stripped(item) for item in value if item != XMP]
    if not isinstance(value, dict):
        return value
    kept = {key: stripped(item) for key, item in value.items() if key not in ("extras", XMP)}
    return {key: item for key, item in kept.items() if item not in ({}, []) or item == value[key]}
