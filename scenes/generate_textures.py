#!/usr/bin/env python3
"""Writes the pictures of glass-and-straw.toml: stripes.png for the straw, oak.png for the table.

    python3 scenes/generate_textures.py scenes
"""
import math
import os
import random
import sys

from picture_files import write_png

WHITE, RED = (0.93, 0.91, 0.87), (0.80, 0.10, 0.12)


def stripes(path):
    """A tile of slanted stripes: wound around a straw (u once around, v along both of its walls) they are a helix."""
    width, height, turns = 32, 1024, 36

    def pixel(x, y):
        phase = (x / width + turns * y / height) % 1.0
        edge = min(abs(phase - 0.0), abs(phase - 0.5), abs(phase - 1.0))  # one texel of blending, no more
        share = 0.5 + (0.5 if phase < 0.5 else -0.5) * min(1.0, edge / 0.03)
        return tuple(w + (r - w) * share for w, r in zip(WHITE, RED))

    write_png(path, width, height, pixel)


def noise(seed, columns, rows):
    """Smooth value noise that repeats after columns x rows cells."""
    source = random.Random(seed)
    lattice = [[source.random() for _ in range(columns)] for _ in range(rows)]

    def value(x, y):
        i, j = math.floor(x), math.floor(y)
        fx, fy = x - i, y - j
        fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
        a, b = lattice[j % rows], lattice[(j + 1) % rows]
        low = a[i % columns] + (a[(i + 1) % columns] - a[i % columns]) * fx
        return low + (b[i % columns] + (b[(i + 1) % columns] - b[i % columns]) * fx - low) * fy

    return value


def oak(path):
    """Five planks side by side, grain along x; it repeats both ways."""
    width, height, planks = 512, 320, 5
    wave, grain, pores = noise(1, 6, 40), noise(2, 10, 160), noise(3, 48, 320)
    tone = [0.92, 1.06, 0.98, 1.10, 0.95]

    def pixel(x, y):
        plank, across = divmod(y * planks / height, 1.0)
        shift = 0.37 * plank
        u, v = x / width + shift, y / height
        rings = 0.5 + 0.5 * math.sin(2 * math.pi * (across * 3 + 1.6 * wave(u * 6, v * 40 / 4 + 7 * plank)))
        shade = tone[int(plank)] * (0.80 + 0.11 * rings + 0.14 * grain(u * 10, v * 160) + 0.10 * pores(u * 48, v * 320))
        seam = min(across, 1 - across) * height / planks
        shade *= 0.45 + 0.55 * min(1.0, seam / 1.6)
        return (0.56 * shade, 0.385 * shade, 0.255 * shade)

    write_png(path, width, height, pixel)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: generate_textures.py FOLDER")
    stripes(os.path.join(sys.argv[1], "stripes.png"))
    oak(os.path.join(sys.argv[1], "oak.png"))
