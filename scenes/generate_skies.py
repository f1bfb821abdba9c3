#!/usr/bin/env python3
"""Writes the environments that the scenes' mirrors and glasses see: dawn.hdr and studio.hdr.

    python3 scenes/generate_skies.py scenes
"""
import os
import sys

from picture_files import write_environment


def mix(a, b, share):
    share = min(1.0, max(0.0, share))
    return tuple(x + (y - x) * share for x, y in zip(a, b))


def smooth(low, high, x):
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3 - 2 * t)


def dawn(x, y, z):
    """A clear sky at sunrise: amber where the sun will rise, violet opposite, blue overhead."""
    towards_sun = smooth(-0.7, 1.0, 0.80 * x - 0.60 * z)
    horizon = mix((0.42, 0.24, 0.34), (1.50, 0.66, 0.25), towards_sun)
    belt = mix((0.20, 0.19, 0.36), (0.58, 0.38, 0.40), towards_sun)
    zenith = (0.035, 0.075, 0.20)
    if y < 0:
        return mix(horizon, (0.05, 0.05, 0.07), smooth(0.0, 0.25, -y))
    return mix(mix(horizon, belt, smooth(0.0, 0.24, y)), zenith, smooth(0.10, 0.85, y))


def studio(x, y, z):
    """A dim room with a wall that glows softly behind the table, a tall window left and a narrow strip right."""
    color = mix((0.012, 0.014, 0.018), (0.05, 0.055, 0.065), smooth(-0.2, 1.0, y))
    if z < 0:
        glow = smooth(0.85, 0.0, ((x / 0.9) ** 2 + ((y - 0.10) / 0.55) ** 2) ** 0.5)
        color = mix(color, (0.80, 0.60, 0.42), glow)
    window = smooth(0.0, 0.03, 0.24 - abs(z - 0.20)) * smooth(0.0, 0.05, 0.42 - abs(y - 0.40))
    bars = smooth(0.008, 0.016, abs(z - 0.20)) * smooth(0.010, 0.020, abs(y - 0.42))
    if x < 0:
        return mix(color, (5.2, 5.6, 6.2), window * bars)
    return mix(color, (2.6, 2.1, 1.6), smooth(0.0, 0.03, 0.10 - abs(z + 0.10)) * smooth(0.0, 0.05, 0.45 - abs(y - 0.40)))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: generate_skies.py FOLDER")
    write_environment(os.path.join(sys.argv[1], "dawn.hdr"), 96, dawn)
    write_environment(os.path.join(sys.argv[1], "studio.hdr"), 256, studio)
