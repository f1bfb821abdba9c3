#!/usr/bin/env python3
"""Writes a benchmark scene of a million triangles into a folder: terrain.toml, terrain.obj and boulders.obj.

    python3 scenes/generate_terrain.py FOLDER [--triangles N] [--seed N]
    raymill render FOLDER/terrain.toml --stats

A square of hills, displaced by fractal noise and smooth by its vertex normals, with balls and boulders strewn over it:
coherent camera rays, long grazing shadow rays, and spheres beside triangles in one hierarchy. One sample a pixel, a low
sun, no mirror, so that camera and shadow rays are what is timed. The same arguments write the same bytes.
"""
import argparse
import math
import os
import random

SIDE = 200.0  # of the square, scene units
HEIGHT = 26.0
OCTAVES = 7
BOULDERS, BALLS = 300, 200
SUBDIVISIONS = 3  # of a boulder's octahedron: 8 * 4^3 = 512 triangles


def lattice_noise(seed, size):
    """Value noise in [-1, 1] on a size x size lattice that repeats, and its interpolation with continuous slopes."""
    source = random.Random(seed)
    values = [[source.uniform(-1, 1) for _ in range(size)] for _ in range(size)]

    def noise(x, y):
        i, j = math.floor(x), math.floor(y)
        u, v = x - i, y - j
        u, v = u * u * u * (u * (u * 6 - 15) + 10), v * v * v * (v * (v * 6 - 15) + 10)
        low, high = values[j % size], values[(j + 1) % size]
        a, b, c, d = low[i % size], low[(i + 1) % size], high[i % size], high[(i + 1) % size]
        return a + (b - a) * u + (c - a + (a - b - c + d) * u) * v

    return noise


def fractal(noise, x, z):
    """Octaves at double frequency and half strength; valleys are smoother than ridges."""
    total, strength, frequency = 0.0, 1.0, 5.0 / SIDE
    for octave in range(OCTAVES):
        total += strength * noise(x * frequency + 17.3 * octave, z * frequency)
        frequency *= 2.0
        strength *= 0.42 + 0.10 * max(-0.5, min(0.5, total))
    return HEIGHT * 0.5 * total


def unit(v):
    length = math.sqrt(sum(c * c for c in v))
    return tuple(c / length for c in v)


def octahedron_sphere():
    """A unit sphere's points and counter-clockwise triangles by repeated halving of an octahedron's edges."""
    points = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(2, 4, 0), (2, 0, 5), (2, 5, 1), (2, 1, 4), (3, 0, 4), (3, 5, 0), (3, 1, 5), (3, 4, 1)]
    for _ in range(SUBDIVISIONS):
        middle_of, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle_of:
                middle_of[key] = len(points)
                points.append(unit([p + q for p, q in zip(points[a], points[b])]))
            return middle_of[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = finer
    return points, faces


def write_hills(file, height, cells):
    """Two triangles a cell, normals by central differences."""
    step = SIDE / cells
    for j in range(cells + 1):
        rows = []
        for i in range(cells + 1):
            x, z = i * step - SIDE / 2, j * step - SIDE / 2
            slope_x = height(i + 1, j) - height(i - 1, j)
            slope_z = height(i, j + 1) - height(i, j - 1)
            rows.append("v %.4f %.4f %.4f\nvn %.4f %.4f %.4f\n" % (x, height(i, j), z,
                                                                   *unit((-slope_x, 2 * step, -slope_z))))
        file.write("".join(rows))
    for j in range(cells):
        rows = []
        for i in range(cells):
            a = j * (cells + 1) + i + 1
            b, c, d = a + cells + 1, a + cells + 2, a + 1
            rows.append(f"f {a}//{a} {b}//{b} {c}//{c}\nf {a}//{a} {c}//{c} {d}//{d}\n")
        file.write("".join(rows))


def write_boulders(file, source, ground, noise):
    """Spheres dented by noise, without normals of their own, so flat."""
    points, faces = octahedron_sphere()
    first = 0
    for number in range(BOULDERS):
        x, z = (source.uniform(-0.48, 0.48) * SIDE for _ in range(2))
        size = 0.4 + 1.6 * source.random() ** 3
        y = ground(x, z) + 0.4 * size
        file.write(f"g boulder_{number}\n")
        for p in points:
            dent = 1 + 0.3 * noise(2.1 * p[0] + 3 * number, 2.1 * p[1] + 1.7 * p[2])
            file.write("v %.4f %.4f %.4f\n" % tuple(c + size * dent * q for c, q in zip((x, y, z), p)))
        file.write("".join("f %d %d %d\n" % tuple(first + 1 + c for c in face) for face in faces))
        first += len(points)


SCENE_HEAD = """# A benchmark of many triangles, written by generate_terrain.py: hills with boulders and balls in low sun.

[render]
size = [1280, 720]
spp = 1
depth = 1
background = [0.42, 0.55, 0.78]

[camera]
eye = {eye}
look_at = {look_at}
fov = 42

[[light]]
name = "sun"
type = "directional"
direction = [-0.80, -0.50, -0.35]
intensity = [1.25, 1.05, 0.80]

[[light]]
name = "sky"
type = "ambient"
color = [0.20, 0.26, 0.36]

[[material]]
name = "moor"
ambient = [0.55, 0.58, 0.42]
diffuse = [0.40, 0.42, 0.24]

[[material]]
name = "granite"
ambient = 0.6
diffuse = [0.52, 0.50, 0.48]
shading = "flat"

[[material]]
name = "paint"
ambient = [0.80, 0.30, 0.16]
diffuse = [0.78, 0.24, 0.10]
specular = 0.4
shininess = 60

[[object]]
name = "terrain"
shape = "mesh"
file = "terrain.obj"
material = "moor"

[[object]]
name = "boulders"
shape = "mesh"
file = "boulders.obj"
material = "granite"
"""

BALL = """
[[object]]
shape = "sphere"
material = "paint"
center = [{:.3f}, {:.3f}, {:.3f}]
radius = {:.3f}
"""


def main():
    parser = argparse.ArgumentParser(description="Write a benchmark scene of many triangles.")
    parser.add_argument("folder", help="where terrain.toml, terrain.obj and boulders.obj go; made if it is not there")
    parser.add_argument("--triangles", type=int, default=1_000_000, help="of hills and boulders, about")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    boulder_triangles = BOULDERS * 8 * 4**SUBDIVISIONS
    if arguments.triangles < 2 * boulder_triangles:
        parser.error(f"--triangles must be at least {2 * boulder_triangles}")
    cells = round(math.sqrt((arguments.triangles - boulder_triangles) / 2))

    noise = lattice_noise(arguments.seed, 64)
    ground = lambda x, z: fractal(noise, x, z)
    step = SIDE / cells
    # One ring more than there are vertices: the normals at the rim need it.
    heights = [[ground(i * step - SIDE / 2, j * step - SIDE / 2) for i in range(-1, cells + 2)]
               for j in range(-1, cells + 2)]
    source = random.Random(arguments.seed + 1)

    os.makedirs(arguments.folder, exist_ok=True)
    with open(os.path.join(arguments.folder, "terrain.obj"), "w", encoding="ascii") as file:
        write_hills(file, lambda i, j: heights[j + 1][i + 1], cells)
    with open(os.path.join(arguments.folder, "boulders.obj"), "w", encoding="ascii") as file:
        write_boulders(file, source, ground, noise)
    eye_x, eye_z = 0.0, 0.46 * SIDE
    eye = [eye_x, round(max(ground(eye_x, eye_z), ground(eye_x, eye_z - 12)) + 9.0, 3), eye_z]
    with open(os.path.join(arguments.folder, "terrain.toml"), "w", encoding="ascii") as file:
        file.write(SCENE_HEAD.format(eye=eye, look_at=[0.0, round(eye[1] - 22.0, 3), -10.0]))
        for _ in range(BALLS):
            x, z = (source.uniform(-0.48, 0.48) * SIDE for _ in range(2))
            radius = 0.3 + 1.2 * source.random() ** 2
            file.write(BALL.format(x, ground(x, z) + 0.7 * radius, z, radius))


if __name__ == "__main__":
    main()
