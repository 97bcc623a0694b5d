"""The add-on of clients/blender in a Blender without a window: addon_test.py, by blender --background --python.

A bar of steel falls on a board of oak by keyframes. The sound must begin at the moment at which it lands.
"""
import importlib.util
import os
import sys
import tempfile

import bpy
import numpy as np

SOURCE = os.environ["RINGDOWN_SOURCE_DIR"]
FPS, FIRST, LAST = 24, 1, 48
HEIGHT_M, GRAVITY = 0.4, 9.81


def box(name, size_m, z_m, material):
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, z_m))
    thing = bpy.context.object
    thing.name = name
    thing.scale = size_m
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    thing.data.materials.append(bpy.data.materials.new(material))
    return thing


def build(fps_base=1.0):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    load_addon()
    scene = bpy.context.scene
    scene.render.fps, scene.render.fps_base = FPS, fps_base
    scene.frame_start, scene.frame_end = FIRST, LAST
    box("Board", (0.2, 0.2, 0.03), -0.015, "Oak board")
    bar = box("Bar", (0.12, 0.04, 0.01), 0.005 + HEIGHT_M, "no known material")
    bar.ringdown_material = "steel"
    for frame in range(FIRST, LAST + 1):
        time = (frame - FIRST) * fps_base / FPS
        bar.location.z = 0.005 + height_at(time)
        bar.keyframe_insert("location", frame=frame)
    bpy.ops.object.camera_add(location=(0, -1, 0.4), rotation=(1.2, 0, 0))
    scene.camera = bpy.context.object
    return scene


def landing_s():
    return np.sqrt(2 * HEIGHT_M / GRAVITY)


def height_at(time):
    """A fall, and a bounce with half of the speed, after which it rests."""
    if time < landing_s():
        return HEIGHT_M - GRAVITY * time**2 / 2
    since, speed = time - landing_s(), 0.5 * GRAVITY * landing_s()
    return max(speed * since - GRAVITY * since**2 / 2, 0)


def load_addon():
    spec = importlib.util.spec_from_file_location("ringdown_foley", os.path.join(SOURCE, "clients/blender/ringdown_foley.py"))
    module = importlib.util.module_from_spec(spec)
    sys.modules["ringdown_foley"] = module
    spec.loader.exec_module(module)
    if not hasattr(bpy.types.Scene, "ringdown"):
        module.register()
    return module


def read(path):
    """The samples of a 32-bit float WAV, one row for each channel."""
    with open(path, "rb") as file:
        data = file.read()
    at = data.index(b"fmt ")
    channels, rate = np.frombuffer(data, "<u2", 1, at + 10)[0], np.frombuffer(data, "<u4", 1, at + 12)[0]
    at = data.index(b"data")
    size = np.frombuffer(data, "<u4", 1, at + 4)[0]
    return np.frombuffer(data, "<f4", size // 4, at + 8).reshape(-1, channels).T, int(rate)


def onset_s(path):
    samples, rate = read(path)
    loud = np.abs(samples).max(axis=0)
    assert loud.max() > 0.01, f"nothing is heard: {loud.max()}"
    return np.argmax(loud > 0.05 * loud.max()) / rate


def check(fps_base):
    with tempfile.TemporaryDirectory() as folder:
        scene = build(fps_base)
        addon = sys.modules["ringdown_foley"]
        assert "steel" in addon.materials() and "wood" in addon.materials(), addon.materials()
        assert addon.search_materials(None, bpy.context, "STEE"), "the search finds no steel"
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "fall.blend"))
        if fps_base == 1:
            assert bpy.ops.ringdown.bake() == {"FINISHED"}
            assert os.path.exists(os.path.join(folder, "fall-ringdown.glb"))
        scene.ringdown.stems = scene.ringdown.normalize = True
        for _ in range(2 if fps_base == 1 else 1):  # the second replaces the first
            assert bpy.ops.ringdown.render_sound() == {"FINISHED"}
        sound = os.path.join(folder, "fall-ringdown.wav")
        strips = [s for s in scene.sequence_editor.sequences if s.type == "SOUND"]
        assert [s.name for s in strips] == ["Ringdown"], strips
        assert os.path.realpath(bpy.path.abspath(strips[0].sound.filepath)) == os.path.realpath(sound)
        assert strips[0].frame_start == FIRST, strips[0].frame_start
        # A blow is placed within 2 ms, and sound that comes from a metre away has no delay by default.
        assert abs(onset_s(sound) - landing_s()) < 0.003, (onset_s(sound), landing_s())
        stems = sorted(os.listdir(os.path.join(folder, "fall-ringdown-stems")))
        assert "Bar-impact.wav" in stems and "Board-impact.wav" in stems, stems


def check_errors():
    scene = build()
    bpy.context.scene.objects["Bar"].ringdown_material = "unobtainium"
    try:
        bpy.ops.ringdown.bake()
    except RuntimeError as error:
        assert "unobtainium" in str(error), error
        return
    raise AssertionError("a bake of an unknown material succeeds")


check(1.0)
check(1.001)
check_errors()
print("the add-on works")
