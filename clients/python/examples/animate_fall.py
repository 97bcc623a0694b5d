#!/usr/bin/env python3
"""Writes an animation as programs for pictures export it, without physics: animate_fall.py [fall.glb] [FPS]

A glass, a spoon and a plate fall on a table of oak and bounce. Only keyframes and names of ordinary materials are in it.
"""
import json
import struct
import sys

import numpy as np

GRAVITY = 9.81


def revolved(profile, around=48):
    """A closed surface from a closed profile of (radius, height), which turns about the y axis."""
    points, triangles, rings = [], [], []
    for radius, height in profile:
        if radius == 0:
            rings.append([len(points)] * around)
            points.append((0, height, 0))
            continue
        rings.append(list(range(len(points), len(points) + around)))
        for k in range(around):
            angle = 2 * np.pi * k / around
            points.append((radius * np.cos(angle), height, radius * np.sin(angle)))
    for low, high in zip(rings, rings[1:]):
        for k in range(around):
            a, b, c, d = low[k], low[(k + 1) % around], high[(k + 1) % around], high[k]
            triangles += [t for t in ((a, d, b), (b, d, c)) if len(set(t)) == 3]
    return np.array(points, "<f4"), np.array(triangles, "<u4")


def box(x, y, z):
    corners = [((k & 1) - 0.5, ((k >> 1) & 1) - 0.5, ((k >> 2) & 1) - 0.5) for k in range(8)]
    sides = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6),
             (1, 3, 5), (3, 7, 5)]
    return np.array(corners, "<f4") * np.array([x, y, z], "<f4"), np.array(sides, "<u4")


def bounces(times, start, height, bounce):
    """The height of what falls from `height` at `start` on a floor, and bounces until it rests."""
    result, at, velocity, y = [], start, 0.0, height
    for time in times:
        while time > at:
            land = at + (velocity + np.sqrt(velocity**2 + 2 * GRAVITY * y)) / GRAVITY
            if land > time or abs(velocity) + y < 1e-3:
                break
            velocity, y, at = bounce * (GRAVITY * (land - at) - velocity), 0.0, land
            if velocity < 0.15:
                velocity = 0.0
                break
        t = max(time - at, 0)
        result.append(max(y + velocity * t - GRAVITY * t * t / 2, 0.0) if y > 0 or velocity > 0 else 0.0)
    return result


def main():
    output = sys.argv[1] if len(sys.argv) > 1 else "fall.glb"
    fps = float(sys.argv[2]) if len(sys.argv) > 2 else 24
    times = np.arange(int(3 * fps) + 1) / fps
    glass = [(0, 0), (0.03, 0), (0.035, 0.1), (0.032, 0.1), (0.027, 0.006), (0, 0.006)]
    plate = [(0, 0), (0.07, 0), (0.12, 0.02), (0.12, 0.025), (0.07, 0.006), (0, 0.006)]
    things = [  # name, material, shape, where on the table, start, height, bounce, how high its middle is
        ("Glass", "wine glass 02", revolved(glass), (-0.25, 0), 0.2, 0.15, 0.45, 0),
        ("Spoon", "Steel", box(0.16, 0.004, 0.02), (0, 0.15), 0.7, 0.4, 0.4, 0.002),
        ("Plate", "porcelain_white", revolved(plate), (0.2, 0), 1.2, 0.25, 0.35, 0),
        ("Table", "Oak", box(1.2, 0.03, 0.8), (0, 0), None, 0, 0, -0.015),
    ]
    data, views, accessors = b"", [], []

    def accessor(array, kind, component):
        nonlocal data
        data += b"\0" * (-len(data) % 4)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        data += array.tobytes()
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(array), "type": kind})
        if kind != "SCALAR" or component == 5126:
            accessors[-1]["min"] = np.atleast_1d(array.min(axis=0)).tolist()
            accessors[-1]["max"] = np.atleast_1d(array.max(axis=0)).tolist()
        return len(accessors) - 1

    clock = accessor(times.astype("<f4"), "SCALAR", 5126)
    nodes, meshes, materials, channels, samplers = [], [], [], [], []
    for name, material, (points, triangles), (x, z), start, height, bounce, middle in things:
        meshes.append({"primitives": [{"attributes": {"POSITION": accessor(points, "VEC3", 5126)},
                                       "indices": accessor(triangles.reshape(-1), "SCALAR", 5125), "material": len(nodes)}]})
        materials.append({"name": material})
        nodes.append({"name": name, "mesh": len(nodes), "translation": [x, middle, z]})
        if start is None:
            continue
        way = np.array([(x, middle + y, z) for y in bounces(times, start, height, bounce)], "<f4")
        samplers.append({"input": clock, "output": accessor(way, "VEC3", 5126)})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": len(nodes) - 1, "path": "translation"}})
    nodes.append({"name": "Camera", "camera": 0, "translation": [0, 0.4, 1.2], "rotation": [-0.15, 0, 0, 0.98869]})
    data += b"\0" * (-len(data) % 4)
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
        "meshes": meshes, "materials": materials, "accessors": accessors, "bufferViews": views,
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.01}}],
        "buffers": [{"byteLength": len(data)}], "animations": [{"channels": channels, "samplers": samplers}],
    }).encode()
    text += b" " * (-len(text) % 4)
    with open(output, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)


main()
