#!/usr/bin/env python3
"""Surfaces as artists and scanners leave them, each with what it should have been.

usage: ugly_assets.py FOLDER [NAME...]      writes NAME.ply and, where there is one, its truth NAME.truth.geo or .ply
       ugly_assets.py --list                prints names, triangles and what is wrong

Every function below that @asset marks makes one asset; lengths are metres. The same bytes come out every time. The
truth is the sound body: text for gmsh's OpenCASCADE kernel, or a clean surface where no such text can describe it.
What is round in the truth has 96 sides or more here, so that its frequencies are within 0.05 %.
"""
import dataclasses
import os
import struct
import sys

import numpy as np

ASSETS = {}


@dataclasses.dataclass
class Asset:
    wrong: str  # what is wrong with it, in words
    surface: np.ndarray  # T x 3 x 3 [m]
    geo: str = ""  # the sound body for OpenCASCADE
    clean: np.ndarray = None  # or its sound surface, T x 3 x 3 [m]


def asset(make):
    ASSETS[make.__name__] = make
    return make


# Shapes. Each returns triangles, counter-clockwise from outside.


def from_grid(points, closed_rows, closed_columns):
    """Triangles of a grid of points, rows x columns x 3; those without area are left out."""
    rows, columns = points.shape[:2]
    i, j = np.meshgrid(np.arange(rows - (not closed_rows)), np.arange(columns - (not closed_columns)), indexing="ij")
    k, l = (i + 1) % rows, (j + 1) % columns
    a, b, c, d = points[i, j], points[i, l], points[k, l], points[k, j]
    faces = np.concatenate([np.stack([a, b, c], 2).reshape(-1, 3, 3), np.stack([a, c, d], 2).reshape(-1, 3, 3)])
    area = np.linalg.norm(np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0]), axis=1)
    return faces[area > 1e-14]


def box(low, high):
    low, high = np.asarray(low, float), np.asarray(high, float)
    corners = np.array([[(high if c >> k & 1 else low)[k] for k in range(3)] for c in range(8)])
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return np.array([corners[[q[0], q[i], q[i + 1]]] for q in quads for i in (1, 2)])


def lathe(profile, segments):
    """A closed polygon of (r, z), the inside to its left, turned about z."""
    profile = np.asarray(profile, float)
    angle = 2 * np.pi * np.arange(segments) / segments
    r, z = profile[:, :1], np.broadcast_to(profile[:, 1:], (len(profile), segments))
    return from_grid(np.stack([r * np.cos(angle), r * np.sin(angle), z], 2), True, True)


def cylinder(radius, height, segments=96):
    return lathe([(0, 0), (radius, 0), (radius, height), (0, height)], segments)


def cup(radius, height, wall, segments=128, base=None):
    base = wall if base is None else base
    inner = radius - wall
    return lathe([(0, 0), (radius, 0), (radius, height), (inner, height), (inner, base), (0, base)], segments)


def ball(radius, segments=96):
    angle = np.pi * np.arange(segments // 2 + 1) / (segments // 2)
    return lathe(np.stack([radius * np.sin(angle) * (np.sin(angle) > 1e-9), -radius * np.cos(angle)], 1), segments)


def bowl(radius, wall, segments=128):
    angle = np.pi / 2 * np.arange(segments // 4 + 1) / (segments // 4)
    ring = np.stack([np.sin(angle), -np.cos(angle)], 1)
    ring[-1, 1] = 0
    return lathe(np.concatenate([radius * ring, (radius - wall) * ring[::-1]]), segments)


def bent_rod(path, radius, segments=48):
    """A round rod along a path in the x-z plane, closed at both ends."""
    path = np.asarray(path, float)
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1)[:, None]
    y = np.array([0, 1.0, 0])
    across = np.cross(along, y)
    angle = -2 * np.pi * np.arange(segments) / segments
    rings = path[:, None] + radius * (
        np.cos(angle)[None, :, None] * across[:, None] + np.sin(angle)[None, :, None] * y
    )
    ends = [np.broadcast_to(path[0], (1, segments, 3)), rings, np.broadcast_to(path[-1], (1, segments, 3))]
    return outward(from_grid(np.concatenate(ends), False, True))


def handle(at, middle, reach, radius, steps=48):
    """Half a ring that starts and ends at x = at."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, steps)
    path = np.stack([at + reach * np.cos(angle), 0 * angle, middle + reach * np.sin(angle)], 1)
    return bent_rod(path, radius)


def geodesic(frequency):
    """A unit ball of 20 frequency^2 triangles."""
    golden = (1 + 5**0.5) / 2
    corners = np.array([[s, t * golden, 0] for s in (-1, 1) for t in (-1, 1)])
    corners = np.concatenate([np.roll(corners, k, axis=1) for k in range(3)])
    distance = np.linalg.norm(corners[:, None] - corners[None], axis=2)
    near = np.abs(distance - 2) < 1e-9
    triples = [(a, b, c) for a in range(12) for b in range(a) for c in range(b)]
    faces = [(a, b, c) for a, b, c in triples if near[a, b] and near[b, c] and near[a, c]]
    i, j = np.meshgrid(np.arange(frequency), np.arange(frequency), indexing="ij")
    up, down = i + j < frequency, i + j < frequency - 1
    made = []
    for face in faces:
        a, b, c = corners[list(face)]

        def at(u, v):
            return a + (b - a) * (u / frequency)[:, None] + (c - a) * (v / frequency)[:, None]

        u, v = i[up], j[up]
        made.append(np.stack([at(u, v), at(u + 1, v), at(u, v + 1)], 1))
        u, v = i[down], j[down]
        made.append(np.stack([at(u + 1, v), at(u + 1, v + 1), at(u, v + 1)], 1))
    made = np.concatenate(made)
    made /= np.linalg.norm(made, axis=2)[:, :, None]
    turned = np.einsum("ij,ij->i", np.cross(made[:, 1] - made[:, 0], made[:, 2] - made[:, 0]), made.mean(1)) < 0
    made[turned] = made[turned][:, ::-1]
    return np.round(made, 12)


def figurine(frequency, length=0.18):
    """A smooth sitting animal: a body, a head, two ears, as one surface around a point."""
    way = geodesic(frequency)
    ears = [((0.25, side * 0.3, 0.93), 0.55, 40) for side in (1, -1)]
    lumps = [((0, 0, -0.2), 0.5, 3), ((0.55, 0, 0.6), 0.45, 9), *ears]
    radius = np.full(way.shape[:2], 0.55)
    for to, height, sharp in lumps:
        to = np.asarray(to) / np.linalg.norm(to)
        radius += height * np.exp(sharp * (way @ to - 1))
    return length / 2.18 * way * radius[:, :, None]


# Changes.


def outward(surface):
    volume = np.einsum("ij,ij->", surface[:, 0], np.cross(surface[:, 1], surface[:, 2]))
    return surface if volume > 0 else surface[:, ::-1]


def moved(surface, by):
    return surface + np.asarray(by, float)


def turned(surface, axis, degrees):
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    angle = np.radians(degrees)
    cross = np.cross(np.eye(3), axis)
    return surface @ (np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def together(*surfaces):
    return np.concatenate(surfaces)


def finer(surface, times=1):
    """Each triangle in four."""
    for _ in range(times):
        a, b, c = surface[:, 0], surface[:, 1], surface[:, 2]
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        surface = np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return surface


def shaken(surface, by, seed=1):
    """Every point moved by a normal deviate; the surface stays closed."""
    points, index = np.unique(np.round(surface.reshape(-1, 3), 10), axis=0, return_inverse=True)
    points = points + np.random.default_rng(seed).normal(0, by, points.shape)
    return points[index.reshape(-1)].reshape(-1, 3, 3)


def without(surface, share, seed=1):
    return surface[np.random.default_rng(seed).random(len(surface)) >= share]


def flipped(surface, share, seed=1):
    surface = surface.copy()
    some = np.random.default_rng(seed).random(len(surface)) < share
    surface[some] = surface[some][:, ::-1]
    return surface


def outward_normal(surface, triangle):
    """Of a triangle of a closed surface, however its triangles are turned: a ray leaves it through an even number."""
    a, b, c = surface[:, 0], surface[:, 1], surface[:, 2]
    normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
    normal /= np.linalg.norm(normal)
    way = normal + np.array([0.0031, 0.0017, 0.0023])  # through no edge
    start = triangle.mean(0) + 1e-6 * np.ptp(surface) * normal
    across = np.cross(way, c - a)
    determinant = np.einsum("ij,ij->i", b - a, across)
    sound = determinant != 0
    determinant = np.where(sound, determinant, 1)
    u = np.einsum("ij,ij->i", start - a, across) / determinant
    other = np.cross(start - a, b - a)
    v, far = other @ way / determinant, np.einsum("ij,ij->i", c - a, other) / determinant
    hits = sound & (u >= 0) & (v >= 0) & (u + v <= 1) & (far > 0)
    return -normal if np.count_nonzero(hits) % 2 else normal


def slit(surface):
    """Without the triangles across the middle of the second longest axis, on the upper half of the shortest one, that
    face away from the middle: of a wall only one side is slit, so that the body is still the same."""
    low, high = surface.min((0, 1)), surface.max((0, 1))
    shortest, second, _ = np.argsort(high - low)
    middle = (low + high) / 2 + 1e-3 * (high - low)  # beside planes of symmetry, which nodes lie on
    crossing = (surface[:, :, second].min(1) < middle[second]) & (surface[:, :, second].max(1) > middle[second])
    gone = np.flatnonzero(crossing & (surface[:, :, shortest].mean(1) > middle[shortest]))
    outward = [n for n in gone if np.dot(outward_normal(surface, surface[n]), surface[n].mean(0) - middle) > 0]
    return np.delete(surface, outward, axis=0)


def with_t_joints(surface, share, seed=1):
    """Some triangles cut in two at the middle of a side, their neighbours not."""
    cut = np.random.default_rng(seed).random(len(surface)) < share
    a, b, c = surface[cut, 0], surface[cut, 1], surface[cut, 2]
    middle = (a + b) / 2
    return np.concatenate([surface[~cut], np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])


# Texts of truths.

OCC = 'SetFactory("OpenCASCADE");\n'


BLOCK = "Box(1) = {0, 0, 0, 0.1, 0.08, 0.06};\n"
BAR = "Box(1) = {0, 0, 0, 0.2, 0.02, 0.01};\n"
BALL = "Sphere(1) = {0, 0, 0, 0.1};\n"
UNION = "BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n"
DIFFERENCE = "BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n"


def lathe_geo(profile):
    """What lathe() makes, but round."""
    count = len(profile)
    text = [f"Point({n + 1}) = {{{r}, 0, {z}}};" for n, (r, z) in enumerate(profile)]
    text += [f"Line({n + 1}) = {{{n + 1}, {(n + 1) % count + 1}}};" for n in range(count)]
    text.append(f"Curve Loop(1) = {{1:{count}}};\nPlane Surface(1) = {{1}};")
    text.append("Extrude { {0, 0, 1}, {0, 0, 0}, 2*Pi } { Surface{1}; }\nRecursive Delete { Surface{1}; }\n")
    return OCC + "\n".join(text)


def mug_geo(radius, height, wall, middle, reach, section, at):
    """The cup with half a ring, whose ends are cut off by the cup's inside."""
    return OCC + (
        f"Cylinder(1) = {{0, 0, 0, 0, 0, {height}, {radius}}};\n"
        f"Torus(2) = {{{at}, 0, {middle}, {reach}, {section}, Pi}};\n"
        f"Rotate {{{{0, 0, 1}}, {{{at}, 0, {middle}}}, -Pi/2}} {{ Volume{{2}}; }}\n"
        f"Rotate {{{{1, 0, 0}}, {{{at}, 0, {middle}}}, Pi/2}} {{ Volume{{2}}; }}\n"
        "BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n"
        f"Cylinder(4) = {{0, 0, {wall}, 0, 0, {height}, {radius - wall}}};\n"
        "BooleanDifference(5) = { Volume{3}; Delete; }{ Volume{4}; Delete; };\n"
    )


MUG = dict(radius=0.04, height=0.09)
HANDLE = dict(middle=0.045, reach=0.024)


def mug(wall, segments=128):
    """A cup and, as another shell, a handle whose ends lie in the middle of its wall."""
    at = MUG["radius"] - wall / 2
    return cup(**MUG, wall=wall, segments=segments), handle(at, radius=0.005, **HANDLE)


def mug_truth(wall):
    return mug_geo(**MUG, wall=wall, section=0.005, at=MUG["radius"] - wall / 2, **HANDLE)


# Shells that run into each other.


@asset
def mug_with_handle():
    return Asset("the handle is a shell of its own that ends inside the wall", together(*mug(0.005)), mug_truth(0.005))


@asset
def thin_mug_with_handle():
    return Asset("mug_with_handle with a wall of 3 mm", together(*mug(0.003)), mug_truth(0.003))


@asset
def thin_mug_with_junk():
    """3.5 mm, with holes, flipped and doubled triangles, T-joints and loose scraps."""
    body, grip = mug(0.0035)
    body = with_t_joints(flipped(without(body, 0.004), 0.03), 0.02)
    junk = without(moved(0.05 * ball(0.04, 16), (0.0, 0.0, 0.05)), 0.3)
    return Asset(
        "an intersecting handle, holes, flipped and doubled triangles, T-joints, scraps",
        together(body, body[::17], grip, junk, moved(junk, (0.03, 0.03, 0.06))),
        mug_truth(0.0035),
    )


@asset
def two_rods():
    """Parallel, 4 mm beside each other, so that they overlap along 15 cm."""
    geo = "Cylinder(1) = {0, 0, 0, 0.3, 0, 0, 0.01};\nCylinder(2) = {0.15, 0.004, 0, 0.2, 0, 0, 0.01};\n"
    a, b = (turned(cylinder(0.01, length), (0, 1, 0), -90) for length in (0.3, 0.2))
    surface = together(a, moved(b, (0.15, 0.004, 0)))
    return Asset("two rods that overlap along half of their length", surface, OCC + geo + UNION)


@asset
def two_rods_mirrored():
    straight = two_rods()
    surface = straight.surface * np.array([-1, 1, 1.0])
    return Asset("the mirror image of two_rods", surface[:, ::-1], straight.geo)


@asset
def two_boxes_half_in_each_other():
    a = box((0, 0, 0), (0.12, 0.04, 0.03))
    return Asset(
        "two equal boxes, half in each other, four faces in common planes",
        together(a, moved(a, (0.06, 0, 0))),
        OCC + "Box(1) = {0, 0, 0, 0.18, 0.04, 0.03};\n",
    )


@asset
def two_boxes_that_touch():
    a, b = box((0, 0, 0), (0.1, 0.04, 0.03)), box((0.1, 0.01, 0.005), (0.18, 0.03, 0.025))
    geo = "Box(1) = {0, 0, 0, 0.1, 0.04, 0.03};\nBox(2) = {0.1, 0.01, 0.005, 0.08, 0.02, 0.02};\n"
    return Asset(
        "two boxes that touch with a part of a face",
        together(a, b),
        OCC + geo + UNION,
    )


@asset
def three_balls():
    places = [(-0.03, 0, 0), (0.03, 0, 0), (0, 0.04, 0.01)]
    geo = "".join(f"Sphere({i + 1}) = {{{x}, {y}, {z}, 0.035}};\n" for i, (x, y, z) in enumerate(places))
    geo += "BooleanUnion(4) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };\n"
    return Asset("three balls that run into each other", together(*(moved(ball(0.035), p) for p in places)), OCC + geo)


@asset
def wind_chime_on_plate():
    """A tube through a disc, with a smaller tube in it, every shell of its own."""
    disc = cylinder(0.06, 0.008)
    tube = moved(lathe([(0.012, 0), (0.016, 0), (0.016, 0.1), (0.012, 0.1)], 96), (0, 0, -0.05))
    geo = (
        "Cylinder(1) = {0, 0, 0, 0, 0, 0.008, 0.06};\nCylinder(2) = {0, 0, -0.05, 0, 0, 0.1, 0.016};\n"
        "Cylinder(3) = {0, 0, -0.05, 0, 0, 0.05, 0.012};\nCylinder(4) = {0, 0, 0.008, 0, 0, 0.042, 0.012};\n"
        "BooleanUnion(5) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n"
        "BooleanDifference(6) = { Volume{5}; Delete; }{ Volume{3, 4}; Delete; };\n"
    )
    return Asset("a tube that runs through a disc", together(disc, tube), OCC + geo)


@asset
def hollow_block():
    outer, inner = box((0, 0, 0), (0.1, 0.08, 0.06)), box((0.02, 0.02, 0.02), (0.08, 0.06, 0.04))
    geo = (
        "Box(1) = {0, 0, 0, 0.1, 0.08, 0.06};\nBox(2) = {0.02, 0.02, 0.02, 0.06, 0.04, 0.02};\n" + DIFFERENCE
    )
    return Asset("nothing: a cavity, wound inward", together(outer, inner[:, ::-1]), OCC + geo)


@asset
def block_with_inner_block():
    outer, inner = box((0, 0, 0), (0.1, 0.08, 0.06)), box((0.02, 0.02, 0.02), (0.08, 0.06, 0.04))
    return Asset("a box inside a box, wound outward: it is part of it", together(outer, inner), OCC + BLOCK)


# Thin walls.


@asset
def thin_bowl_doubled():
    """Its triangles are there twice, half of the copies a micrometre beside the others."""
    surface = bowl(0.08, 0.003)
    geo = (
        "Sphere(1) = {0, 0, 0, 0.08, -Pi/2, 0};\nSphere(2) = {0, 0, 0, 0.077};\n"
        + DIFFERENCE
    )
    copies = together(surface[::2], surface[1::4] + 1e-6)
    return Asset("doubled faces, some a micrometre off", together(surface, copies), OCC + geo)


@asset
def plate_with_slots():
    """A plate of 2 mm with a rib that runs into it and holes in its surface."""
    plate, rib = finer(box((0, 0, 0), (0.2, 0.12, 0.002)), 3), box((0.02, 0.055, -0.01), (0.18, 0.065, 0.001))
    geo = (
        "Box(1) = {0, 0, 0, 0.2, 0.12, 0.002};\nBox(2) = {0.02, 0.055, -0.01, 0.16, 0.01, 0.011};\n"
        "BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };\n"
    )
    ugly = together(without(plate, 0.01), rib)
    return Asset("a thin plate with an intersecting rib and missing triangles", ugly, OCC + geo)


@asset
def thin_tube_flipped():
    profile = [(0.0135, 0), (0.015, 0), (0.015, 0.3), (0.0135, 0.3)]
    surface = flipped(lathe(profile, 128), 0.1)
    bent = "Mesh.MeshSizeFromCurvature = 24;\n"  # else gmsh's first, coarse triangles of the two walls cut each other
    return Asset("a tube of 1.5 mm, a tenth of its triangles flipped", surface, lathe_geo(profile) + bent)


# Holes, noise, folds, joints.


@asset
def ball_with_holes():
    return Asset("one triangle in fifty is missing", without(ball(0.1, 192), 0.02), OCC + BALL)


@asset
def bottle_without_bottom():
    """A closed bottle whose inner and outer bottom are missing, each a hole as wide as its base."""
    outside = [(0, 0), (0.03, 0), (0.03, 0.1), (0.012, 0.13), (0.012, 0.16)]
    inside = [(0.009, 0.16), (0.009, 0.129), (0.026, 0.098), (0.026, 0.005), (0, 0.005)]
    surface = lathe(outside + inside, 96)
    bottom = (np.ptp(surface[:, :, 2], axis=1) < 1e-9) & (surface[:, :, 2].max(1) < 0.01)
    return Asset("two flat holes: the inner and the outer bottom", surface[~bottom], lathe_geo(outside + inside))


@asset
def noisy_ball():
    return Asset("a ball whose points are off by 0.4 mm", shaken(0.1 * geodesic(30), 4e-4), OCC + BALL)


@asset
def noisy_block():
    surface = finer(box((0, 0, 0), (0.1, 0.08, 0.06)), 5)
    return Asset("a block whose points are off by 0.4 mm", shaken(surface, 4e-4), OCC + BLOCK)


@asset
def doubled_bar():
    surface = finer(box((0, 0, 0), (0.2, 0.02, 0.01)), 2)
    return Asset("every face is there twice", together(surface, surface), OCC + BAR)


@asset
def bar_given_inside_out_too():
    surface = finer(box((0, 0, 0), (0.2, 0.02, 0.01)), 2)
    return Asset("every face is there twice, the copy turned", together(surface, surface[:, ::-1]), OCC + BAR)


@asset
def horseshoe_that_cuts_itself():
    """One rod, bent so far that its ends run through each other."""
    angle = np.linspace(0, 2 * np.pi * 1.04, 160)
    path = np.stack([0.06 * np.cos(angle), 0 * angle, 0.06 * np.sin(angle)], 1)
    ring = "Torus(1) = {0, 0, 0, 0.06, 0.008};\n"
    return Asset("one shell whose ends run through each other", bent_rod(path, 0.008, 128), OCC + ring)


@asset
def l_with_t_joints():
    a, b = box((0, 0, 0), (0.12, 0.04, 0.02)), box((0, 0.04, 0), (0.06, 0.08, 0.02))
    geo = "Box(1) = {0, 0, 0, 0.12, 0.04, 0.02};\nBox(2) = {0, 0.04, 0, 0.06, 0.04, 0.02};\n"
    surface = with_t_joints(finer(together(a, b)), 0.2)
    return Asset("two boxes that touch, and T-joints", surface, OCC + geo + UNION)


@asset
def bell_inside_out():
    outside = [(0, 0.1), (0.02, 0.097), (0.03, 0.08), (0.035, 0.04), (0.05, 0)]
    inside = [(0.046, 0), (0.031, 0.04), (0.026, 0.077), (0.017, 0.092), (0, 0.094)]
    surface = outward(lathe(outside + inside, 96))
    ugly = flipped(without(surface[:, ::-1], 0.01), 0.03)
    return Asset("inside out, one triangle in thirty flipped, one in a hundred missing", ugly, lathe_geo(outside + inside))


# Scans.


def scan(frequency, noise, missing=0.0):
    surface = shaken(figurine(frequency), noise, seed=frequency)
    return without(surface, missing, seed=frequency) if missing else surface


@asset
def scan_10_thousand():
    return Asset("a scanned figurine, 9,680 triangles, 0.05 mm noise", scan(22, 5e-5), clean=figurine(64))


@asset
def scan_80_thousand_with_holes():
    surface = scan(64, 5e-5, missing=1 / 300)
    return Asset("81,920 triangles, 0.05 mm noise, one triangle in 300 missing", surface, clean=figurine(64))


@asset
def scan_250_thousand():
    return Asset("250,880 triangles, 0.2 mm noise, which folds them", scan(112, 2e-4), clean=figurine(64))


@asset
def scan_500_thousand():
    return Asset("499,280 triangles, 0.02 mm noise", scan(158, 2e-5), clean=figurine(64))


# Files.


def write_ply(path, surface):
    """A binary PLY with three points to each triangle, as STL has them, but in double precision."""
    count = len(surface)
    head = "ply\nformat binary_little_endian 1.0\n"
    head += f"element vertex {3 * count}\nproperty double x\nproperty double y\nproperty double z\n"
    head += f"element face {count}\nproperty list uchar int vertex_indices\nend_header\n"
    faces = np.zeros(count, dtype=[("n", "u1"), ("corners", "<i4", 3)])
    faces["n"] = 3
    faces["corners"] = np.arange(3 * count).reshape(-1, 3)
    with open(path, "wb") as file:
        file.write(head.encode() + np.ascontiguousarray(surface, "<f8").tobytes() + faces.tobytes())


def write_stl(path, surface):
    rows = np.zeros(len(surface), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    rows["corners"] = surface
    with open(path, "wb") as file:
        file.write(b"\0" * 80 + struct.pack("<I", len(surface)) + rows.tobytes())


def main(arguments):
    if not arguments:
        sys.exit(__doc__)
    if arguments[0] == "--list":
        for name, make in ASSETS.items():
            made = make()
            print(f"{name:32} {len(made.surface):7} {made.wrong}")
        return
    folder, names = arguments[0], arguments[1:] or list(ASSETS)
    os.makedirs(folder, exist_ok=True)
    for name in names:
        made = ASSETS[name]()
        write_ply(os.path.join(folder, name + ".ply"), made.surface)
        if made.geo:
            with open(os.path.join(folder, name + ".truth.geo"), "w", encoding="ascii") as file:
                file.write(made.geo)
        if made.clean is not None:
            write_ply(os.path.join(folder, name + ".truth.ply"), made.clean)


if __name__ == "__main__":
    main(sys.argv[1:])
