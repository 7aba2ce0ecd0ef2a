"""Compares deflate, which .ptc files use, with Zstandard on the same planes: bytes, and the time to unpack them.

    pip install zstandard
    pt scenes/statue.json --size 480x270 --spp 16 --samples 0..16 -o statue.ptc
    python3 benches/peers/zstandard_parts.py statue.ptc

The layout of the files is told in src/part/file.rs and src/part/planes.rs.
"""

import json
import struct
import sys
import time
import zlib

import zstandard

PRELUDE, CHECKSUM, LEVEL = 12, 16, 3


def packed_planes(data):
    """The bytes that deflate has packed, chunk by chunk, and the bytes of all sums."""
    (length,) = struct.unpack("<I", data[8:PRELUDE])
    header, at = json.loads(data[PRELUDE : PRELUDE + length]), PRELUDE + length
    x0, x1, y0, y1 = header["crop"]
    width, pixels, found = header["numbers"], (x1 - x0) * (y1 - y0), []
    most = max(1, (1 << 16) // width)
    while at < len(data) - CHECKSUM:
        for first in range(0, pixels, most):
            (length,) = struct.unpack("<I", data[at : at + 4])
            chunk, at = data[at + 4 : at + 4 + length], at + 4 + length
            ways, count = chunk[: 8 * width], min(most, pixels - first)
            found.append(chunk[8 * width + ways.count(0) + ways.count(1) * count :])
    return found, 8 * width * pixels * len(header["blocks"])


def timed(work, items):
    start = time.process_time()
    results = [work(item) for item in items]
    return results, time.process_time() - start


for path in sys.argv[1:]:
    with open(path, "rb") as file:
        data = file.read()
    deflated, sums = packed_planes(data)
    planes, deflate_seconds = timed(lambda packed: zlib.decompress(packed, -zlib.MAX_WBITS), deflated)
    packed = [zstandard.ZstdCompressor(level=LEVEL).compress(plane) for plane in planes]
    unpacker = zstandard.ZstdDecompressor()
    same, zstandard_seconds = timed(unpacker.decompress, packed)
    assert same == planes
    size = len(data) - sum(map(len, deflated)) + sum(map(len, packed))
    print(f"{path}: deflate {len(data) / sums:.1%} of the sums, unpacked in {deflate_seconds:.4f} s; "
          f"Zstandard {size / sums:.1%}, {zstandard_seconds:.4f} s")
