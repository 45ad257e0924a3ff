"""Reads PNG files of 8 and 16 bits per channel: Pillow reduces colours of 16 bits to 8."""

import struct
import zlib

import numpy as np

# Channels by the colour type of the header.
CHANNELS = {0: 1, 2: 3, 4: 2, 6: 4}


def read(path):
    """Texels in [0, 1], (height, width, channels); neither interlaced nor with a palette."""
    with open(path, "rb") as file:
        data = file.read()
    place, packed = 8, b""
    while place < len(data):
        length, kind = struct.unpack_from(">I4s", data, place)
        content = data[place + 8 : place + 8 + length]
        if kind == b"IHDR":
            width, height, bits, kind_of_color = struct.unpack_from(">IIBB", content)
        elif kind == b"IDAT":
            packed += content
        place += length + 12
    channels = CHANNELS[kind_of_color]
    step = channels * bits // 8
    rows = unfiltered(zlib.decompress(packed), width * step, height, step)
    texels = np.frombuffer(rows, ">u2" if bits == 16 else "u1").reshape(height, width, channels)
    return texels / (2.0**bits - 1)


def unfiltered(data, length, height, step):
    """The bytes of rows of this length, whose neighbours are `step` bytes apart (PNG, section 9)."""
    above, rows = bytes(length), bytearray()
    for start in range(0, height * (length + 1), length + 1):
        row = bytearray(data[start + 1 : start + 1 + length])
        undo(data[start], row, above, step)
        rows += row
        above = row
    return bytes(rows)


def undo(method, row, above, step):
    """Undoes the filter of a row in place."""
    for i in range(len(row)) if method else ():
        left = row[i - step] if i >= step else 0
        if method == 1:
            guess = left
        elif method == 2:
            guess = above[i]
        elif method == 3:
            guess = (left + above[i]) // 2
        else:
            guess = paeth(left, above[i], above[i - step] if i >= step else 0)
        row[i] = (row[i] + guess) & 255


def paeth(left, up, corner):
    """The neighbour closest to left + up − corner."""
    by_left, by_up, by_corner = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
    if by_left <= by_up and by_left <= by_corner:
        return left
    return up if by_up <= by_corner else corner
