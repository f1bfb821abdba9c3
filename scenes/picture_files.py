"""Writes pictures with Python's standard library alone: what the generators of this folder share."""
import math
import struct
import zlib


def write_png(path, width, height, pixel):
    """8-bit sRGB. pixel(x, y) gives three numbers in [0, 1], already encoded; (0, 0) is the top left."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = bytearray()
    for y in range(height):
        rows.append(0)
        for x in range(width):
            rows += bytes(min(255, max(0, round(255 * c))) for c in pixel(x, y))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(bytes(rows), 9)))
        file.write(chunk(b"IEND", b""))


def write_environment(path, height, radiance):
    """Radiance HDR, lat-long, 2 height x height. radiance(x, y, z) gives linear RGB for a unit vector, +y up.

    The middle column looks along +z, with +x to its left: the way Raymill reads an environment map.
    """
    width = 2 * height
    with open(path, "wb") as file:
        file.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width))
        for row in range(height):
            polar = math.pi * (row + 0.5) / height
            for column in range(width):
                angle = 2 * math.pi * (0.5 - (column + 0.5) / width)
                direction = (math.sin(polar) * math.sin(angle), math.cos(polar), math.sin(polar) * math.cos(angle))
                file.write(_rgbe(radiance(*direction)))


def _rgbe(color):
    """Ward's shared exponent: three mantissas of 8 bits."""
    largest = max(color)
    if largest < 1e-32:
        return bytes(4)
    mantissa, exponent = math.frexp(largest)
    return bytes([int(c * mantissa * 256 / largest) for c in color] + [exponent + 128])
