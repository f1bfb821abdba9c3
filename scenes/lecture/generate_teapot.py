#!/usr/bin/env python3
"""Writes a teapot: a turned body with a lid, and a spout and a handle swept along curves.

    python3 scenes/lecture/generate_teapot.py fine scenes/lecture/teapot.obj
    python3 scenes/lecture/generate_teapot.py coarse scenes/lecture/teapot-coarse.obj

The mesh has no normals: a scene chooses with smooth_angle. It stands on y = 0, is 1.86 high, and its spout points to +x.
The parts run into each other, so it is for opaque materials.
"""
import math
import sys

# (r, y), from the middle of the bottom up; each list is one smooth curve, and they meet in edges.
BODY = [
    [(0.0, 0.05), (0.50, 0.05)],
    [(0.50, 0.05), (0.54, 0.0), (0.62, 0.0)],
    [(0.62, 0.0), (0.66, 0.06), (0.86, 0.24), (0.99, 0.50), (1.0, 0.72), (0.92, 0.96), (0.76, 1.16), (0.66, 1.24)],
    [(0.66, 1.24), (0.66, 1.30), (0.62, 1.32)],
    [(0.62, 1.32), (0.50, 1.41), (0.32, 1.49), (0.15, 1.54), (0.09, 1.58)],
    [(0.09, 1.58), (0.10, 1.63), (0.16, 1.70), (0.165, 1.77), (0.11, 1.835), (0.0, 1.86)],
]
SPOUT = [(0.72, 0.42), (1.02, 0.50), (1.22, 0.72), (1.32, 0.98), (1.52, 1.22), (1.62, 1.28)]
SPOUT_RADII = [0.27, 0.25, 0.19, 0.145, 0.125, 0.12]
SPOUT_BORE = [(-0.02, 0.085), (-0.22, 0.075)]  # (along the spout's end, radius) of the rings inside its mouth
HANDLE = [(-0.78, 1.08), (-1.08, 1.16), (-1.38, 1.06), (-1.50, 0.82), (-1.38, 0.52), (-1.08, 0.34), (-0.80, 0.30)]
HANDLE_RADIUS = 0.085


def curve(points, steps):
    """Catmull-Rom through the points (tuples of any length), `steps` pieces between two of them."""
    padded = [points[0]] + list(points) + [points[-1]]
    result = []
    for p0, p1, p2, p3 in zip(padded, padded[1:], padded[2:], padded[3:]):
        for step in range(steps):
            t = step / steps
            result.append(tuple(
                0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t + (3 * b - a - 3 * c + d) * t ** 3)
                for a, b, c, d in zip(p0, p1, p2, p3)))
    return result + [points[-1]]


class Mesh:
    def __init__(self):
        self.vertices = []
        self.faces = []

    def add_ring(self, points):
        first = len(self.vertices) + 1  # OBJ counts from 1
        self.vertices += points
        return list(range(first, first + len(points)))

    def join(self, a, b):
        """Faces between two rings; b follows a, and both turn to the right when one looks along that way."""
        count = max(len(a), len(b))
        for i in range(count):
            j = (i + 1) % count
            corners = [a[i % len(a)], a[j % len(a)], b[j % len(b)], b[i % len(b)]]
            face = [c for k, c in enumerate(corners) if c != corners[k - 1]]
            if len(face) > 2:
                self.faces.append(face)

    def add_body(self, profile, around):
        previous = None
        for r, y in profile:
            angles = [2 * math.pi * i / around for i in range(around if r > 0 else 1)]
            ring = self.add_ring([(r * math.cos(a), y, -r * math.sin(a)) for a in angles])
            if previous:
                self.join(previous, ring)
            previous = ring

    def add_tube(self, path, around, bore=()):
        """path: (x, y, radius) in the plane z = 0."""
        previous = None
        for index, (x, y, radius) in enumerate(path):
            before, after = path[max(index - 1, 0)], path[min(index + 1, len(path) - 1)]
            along = unit(after[0] - before[0], after[1] - before[1])
            previous = self.add_tube_ring(previous, x, y, radius, along, around)
        for distance, radius in bore:
            previous = self.add_tube_ring(previous, x + distance * along[0], y + distance * along[1], radius, along, around)
        if bore:
            self.join(previous, self.add_ring([(x + bore[-1][0] * along[0], y + bore[-1][0] * along[1], 0.0)]))

    def add_tube_ring(self, previous, x, y, radius, along, around):
        points = []
        for i in range(around):
            a = 2 * math.pi * i / around
            side, depth = radius * math.cos(a), radius * math.sin(a)
            points.append((x - along[1] * side, y + along[0] * side, depth))
        ring = self.add_ring(points)
        if previous:
            self.join(previous, ring)
        return ring

    def write(self, path):
        with open(path, "w", encoding="ascii") as out:
            for vertex in self.vertices:
                out.write("v {:.5g} {:.5g} {:.5g}\n".format(*(c + 0.0 if abs(c) > 1e-9 else 0.0 for c in vertex)))
            for face in self.faces:
                out.write("f {}\n".format(" ".join(map(str, face))))


def unit(x, y):
    length = math.hypot(x, y)
    return (x / length, y / length)


def teapot(around, around_tubes, steps):
    mesh = Mesh()
    profile = []
    for part in BODY:
        profile += curve(part, 1 if len(part) == 2 else steps)[1 if profile else 0:]
    mesh.add_body(profile, around)
    spout = [(*p, r) for p, r in zip(SPOUT, SPOUT_RADII)]
    mesh.add_tube(curve(spout, steps), around_tubes, SPOUT_BORE)
    mesh.add_tube(curve([(*p, HANDLE_RADIUS) for p in HANDLE], steps), around_tubes)
    return mesh


def main():
    if len(sys.argv) != 3 or sys.argv[1] not in ("fine", "coarse"):
        sys.exit(__doc__)
    sizes = {"fine": (72, 28, 5), "coarse": (14, 8, 1)}
    teapot(*sizes[sys.argv[1]]).write(sys.argv[2])


if __name__ == "__main__":
    main()
