"""Images of one colour, of any size, in few bytes: they consist of little more than a header."""

import struct
import zlib

PNG_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
# First column, first row, step across, step down of the passes of an interlaced PNG.
ADAM7 = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]


def png(path, size, color=2, bits=8, interlaced=False):
    """`color` is PNG's: 0 grey, 2 RGB, 3 palette, 4 grey with alpha, 6 RGBA."""
    width, height = size
    packer, packed = zlib.compressobj(6), []
    for left, top, across, down in ADAM7 if interlaced else [(0, 0, 1, 1)]:
        columns, rows = -((left - width) // across), -((top - height) // down)
        row = bytes(1 + (columns * PNG_CHANNELS[color] * bits + 7) // 8)
        packed += [packer.compress(row) for _ in range(rows if columns > 0 else 0)]
    header = struct.pack(">IIBBBBB", width, height, bits, color, 0, 0, int(interlaced))
    palette = [(b"PLTE", bytes([128, 128, 255]))] if color == 3 else []
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, data in [(b"IHDR", header), *palette, (b"IDAT", b"".join(packed) + packer.flush()), (b"IEND", b"")]:
            file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))


def segment(marker, data):
    return struct.pack(">BBH", 0xFF, marker, len(data) + 2) + data


def jpeg(path, size, kind="baseline", samplings=(0x11, 0x11, 0x11)):
    """`kind`: baseline, progressive, or scans, which is baseline with a scan for each component.

    Each table has one code, the bit 0, for no change and for the end of a block, so all scans are zeros.
    """
    width, height = size
    numbers = range(1, len(samplings) + 1)
    frame = b"".join(bytes([i, factors, 0]) for i, factors in zip(numbers, samplings))
    code = bytes([1] + [0] * 15 + [0])
    most = [max(s >> 4 for s in samplings), max(s & 15 for s in samplings)]
    mcus = -(-width // (8 * most[0])) * -(-height // (8 * most[1]))
    every = sum(mcus * (s >> 4) * (s & 15) for s in samplings)
    blocks = [-(-width * (s >> 4) // (8 * most[0])) * -(-height * (s & 15) // (8 * most[1])) for s in samplings]
    with open(path, "wb") as file:
        file.write(b"\xff\xd8" + segment(0xDB, bytes([0] + [1] * 64)))
        marker = 0xC2 if kind == "progressive" else 0xC0
        file.write(segment(marker, struct.pack(">BHHB", 8, height, width, len(samplings)) + frame))
        file.write(segment(0xC4, b"\x00" + code) + segment(0xC4, b"\x10" + code))

        def scan(chosen, band, bits):
            parts = b"".join(bytes([i, 0]) for i in chosen)
            file.write(segment(0xDA, bytes([len(chosen)]) + parts + bytes(band)) + bytes((bits + 7) // 8))

        if kind == "baseline":
            scan(numbers, [0, 63, 0], 2 * every)
        elif kind == "scans":
            for i, count in zip(numbers, blocks):
                scan([i], [0, 63, 0], 2 * count)
        else:
            scan(numbers, [0, 0, 0], every)
            for i, count in zip(numbers, blocks):
                scan([i], [1, 63, 0], count)
        file.write(b"\xff\xd9")


def webp(path, size):
    """Lossless: five codes of one symbol each, so that a pixel takes no bit."""
    fields = [(0x2F, 8), (size[0] - 1, 14), (size[1] - 1, 14), (0, 4), (0, 3)]
    for color in [128, 128, 255, 255]:
        fields += [(1, 1), (0, 1), (1, 1), (color, 8)]
    fields += [(1, 1), (0, 1), (0, 1), (0, 1)]
    number, length = 0, 0
    for value, bits in fields:
        number |= value << length
        length += bits
    data = number.to_bytes((length + 7) // 8 + 1, "little")
    data += bytes(len(data) % 2)
    padding = bytes(2 * (size[0] * size[1] // 32768 + 8))
    chunks = b"VP8L" + struct.pack("<I", len(data)) + data + b"JUNK" + struct.pack("<I", len(padding)) + padding
    with open(path, "wb") as file:
        file.write(b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WEBP" + chunks)


def ktx2(path, size):
    """UASTC blocks of one colour with Zstandard, whose blocks here are runs of one byte."""
    unpacked = 16 * -(-size[0] // 4) * -(-size[1] // 4)
    frame = b"\x28\xb5\x2f\xfd\xa0" + struct.pack("<I", unpacked)
    for start in range(0, unpacked, 1 << 17):
        length = min(1 << 17, unpacked - start)
        header = int(start + length == unpacked) | 1 << 1 | length << 3
        frame += header.to_bytes(3, "little") + b"\x17"
    sample = struct.pack("<HBBIII", 0, 127, 0, 0, 0, 0xFFFFFFFF)
    descriptor = struct.pack("<IHHBBBB", 0, 2, 40, 166, 1, 2, 0) + bytes([3, 3, 0, 0, 16] + [0] * 7) + sample
    descriptor = struct.pack("<I", 4 + len(descriptor)) + descriptor
    start = 104 + len(descriptor)
    start += -start % 16
    head = struct.pack("<IIIIIIIII", 0, 1, *size, 0, 0, 1, 1, 2)
    head += struct.pack("<IIIIQQ", 104, len(descriptor), 0, 0, 0, 0) + struct.pack("<QQQ", start, len(frame), unpacked)
    with open(path, "wb") as file:
        file.write(b"\xabKTX 20\xbb\r\n\x1a\n" + head + descriptor)
        file.write(bytes(start - 104 - len(descriptor)) + frame + bytes(size[0] * size[1] // 16384 + 1))


def exr(path, size, channels=("B", "G", "R"), is_half=True):
    """Blocks of 16 lines with ZIP."""
    width, height = size
    kind, depth = (1, 2) if is_half else (2, 4)
    listed = b"".join(name.encode() + struct.pack("<BIIII", 0, kind, 0, 1, 1) for name in sorted(channels)) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    attributes = [
        ("channels", "chlist", listed), ("compression", "compression", b"\x03"), ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window), ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1)), ("screenWindowCenter", "v2f", bytes(8)),
        ("screenWindowWidth", "float", struct.pack("<f", 1)),
    ]
    head = struct.pack("<II", 20000630, 2)
    for name, of, value in attributes:
        head += name.encode() + b"\0" + of.encode() + b"\0" + struct.pack("<I", len(value)) + value
    head += b"\0"
    line = width * depth * len(channels)
    rows = [min(16, height - y) for y in range(0, height, 16)]
    packed = {count: zlib.compress(b"\0" + b"\x80" * (count * line - 1)) for count in set(rows)}
    with open(path, "wb") as file:
        at = len(head) + 8 * len(rows)
        file.write(head)
        for count in rows:
            file.write(struct.pack("<Q", at))
            at += 8 + len(packed[count])
        for i, count in enumerate(rows):
            file.write(struct.pack("<iI", 16 * i, len(packed[count])) + packed[count])


def hdr(path, size):
    width, height = size
    runs = [127] * (width // 127) + [width % 127] * (width % 127 > 0)
    line = b"\2\2" + struct.pack(">H", width)
    line += b"".join(bytes([128 + run, 129]) for _ in range(4) for run in runs)
    with open(path, "wb") as file:
        file.write(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode())
        for _ in range(height):
            file.write(line)


def tga(path, size, channels=3):
    """Runs of 128 pixels."""
    width, height = size
    with open(path, "wb") as file:
        file.write(struct.pack("<BBBHHBHHHHBB", 0, 0, 10, 0, 0, 0, 0, 0, width, height, 8 * channels, 0x20))
        line = (b"\xff" + b"\x80" * channels) * (width // 128)
        for _ in range(height):
            file.write(line)
