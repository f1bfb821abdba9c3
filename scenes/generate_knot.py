#!/usr/bin/env python3
"""Writes knot.obj: a trefoil knot as a tube with smooth normals, for first-light.toml.

    python3 scenes/generate_knot.py scenes/knot.obj

The knot winds three times through the hole of a torus while it goes around it twice. The tube's frame is Frenet's:
on this curve the curvature never vanishes, and the frame closes after one turn because the curve does.
"""
import math
import sys

TURNS, STRANDS = 2, 3  # around the torus' axis, through its hole
RADIUS, RING, TUBE = 1.0, 0.42, 0.235  # of the torus, of the winding around it, of the tube
ALONG, AROUND = 420, 24


def curve(t):
    r = RADIUS + RING * math.cos(STRANDS * t)
    return (r * math.cos(TURNS * t), r * math.sin(TURNS * t), RING * math.sin(STRANDS * t))


def difference(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return tuple(x / length for x in a)


def frame(t, step=1e-3):
    """Normal and binormal at t, from central differences."""
    before, here, after = curve(t - step), curve(t), curve(t + step)
    tangent = unit(difference(after, before))
    bend = tuple(a - 2 * h + b for a, h, b in zip(after, here, before))
    binormal = unit(cross(tangent, bend))
    return cross(binormal, tangent), binormal


def main(path):
    lines = ["# A trefoil knot, written by generate_knot.py.", "o knot"]
    for i in range(ALONG):
        t = 2 * math.pi * i / ALONG
        center, (normal, binormal) = curve(t), frame(t)
        for j in range(AROUND):
            angle = 2 * math.pi * j / AROUND
            out = [math.cos(angle) * n + math.sin(angle) * b for n, b in zip(normal, binormal)]
            lines.append("v %.4f %.4f %.4f" % tuple(c + TUBE * o for c, o in zip(center, out)))
            lines.append("vn %.3f %.3f %.3f" % tuple(out))
    for i in range(ALONG):
        for j in range(AROUND):
            ring, next_ring, k = i * AROUND, (i + 1) % ALONG * AROUND, (j + 1) % AROUND
            corners = (ring + j, ring + k, next_ring + k, next_ring + j)  # seen from outside
            lines.append("f " + " ".join("%d//%d" % (c + 1, c + 1) for c in corners))
    with open(path, "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: generate_knot.py OUTPUT.obj")
    main(sys.argv[1])
