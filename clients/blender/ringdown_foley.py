"""Foley from an animation: a Blender add-on (3.3 or later) around `ringdown bake` and `ringdown foley`.

Install it by Edit > Preferences > Add-ons > Install, and open the tab Ringdown of the 3D view's sidebar (N). Both
commands work on an export beside the .blend file: NAME-ringdown.glb, from which comes NAME-ringdown.wav.
"""
import json
import os
import queue
import re
import shutil
import struct
import subprocess
import threading

import bpy

bl_info = {
    "name": "Ringdown foley",
    "description": "Bakes the sound of objects, and renders that of an animation into the sequencer",
    "author": "Ringdown",
    "version": (1, 0, 0),
    "blender": (3, 3, 0),
    "location": "3D view > Sidebar > Ringdown",
    "category": "Sequencer",
}

STRIP = "Ringdown"
EXIT_SILENCE = 7  # the sound was written and is silent; the program says why


def preferences():
    addon = bpy.context.preferences.addons.get(__name__)
    return addon.preferences if addon else None


def program():
    """The path of `ringdown`, or an error."""
    chosen = bpy.path.abspath(preferences().program) if preferences() else ""
    found = shutil.which(chosen or os.environ.get("RINGDOWN", "ringdown"))
    if not found:
        raise RuntimeError(f"there is no program {chosen or 'ringdown'}: name it in the add-on's preferences")
    return found


_materials = []


def materials():
    """The names of `ringdown materials`, asked once."""
    if not _materials:
        listed = subprocess.run([program(), "materials"], capture_output=True, text=True, check=True).stdout
        _materials.extend(re.findall(r"^([a-z][a-z0-9-]*) +[0-9]", listed, re.MULTILINE))
    return _materials


def search_materials(_object, _context, text):
    try:
        return [name for name in materials() if text.lower() in name]
    except (RuntimeError, OSError, subprocess.SubprocessError):
        return []


def file_beside(ending):
    """A file named after the .blend file, or in Blender's temporary folder while that is not saved."""
    blend = bpy.data.filepath
    folder, name = os.path.split(os.path.splitext(blend)[0]) if blend else (bpy.app.tempdir, "untitled")
    return os.path.join(folder, f"{name}-ringdown{ending}")


def stretch_times(path, factor):
    """Multiplies the times of all keys of a .glb: Blender's exporter leaves out the base of the frame rate (24 / 1.001)."""
    with open(path, "rb") as file:
        data = bytearray(file.read())
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + length])
    start = 20 + length + 8  # of the binary chunk's bytes
    for number in {s["input"] for a in document.get("animations", []) for s in a["samplers"]}:
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        at = start + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        times = struct.unpack_from(f"<{accessor['count']}f", data, at)
        struct.pack_into(f"<{accessor['count']}f", data, at, *(time * factor for time in times))
        for bound in ("min", "max"):
            if bound in accessor:
                accessor[bound] = [value * factor for value in accessor[bound]]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + data[20 + length:]
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)


def export(scene, path):
    bpy.ops.export_scene.gltf(
        filepath=path, export_format="GLB", use_renderable=True, use_active_scene=True, export_apply=True,
        export_cameras=True, export_yup=True, export_animations=True, export_frame_range=True,
        export_force_sampling=True, export_morph=False, export_texcoords=False, export_normals=False,
        export_colors=False, export_image_format="NONE", check_existing=False)
    if scene.render.fps_base != 1:
        stretch_times(path, scene.render.fps_base)


def frames_per_second(scene):
    return scene.render.fps / scene.render.fps_base


def bake_command(scene, path):
    command = [program(), "bake", path, "--progress-lines"]
    for thing in scene.objects:
        if thing.type == "MESH" and thing.ringdown_material:
            command += ["--body", f"{thing.name}={thing.ringdown_material}"]
    return command


def foley_command(scene, path, sound):
    settings = scene.ringdown
    rate = frames_per_second(scene)
    command = [program(), "foley", path, "-o", sound, "--progress-lines", "--to", str(scene.frame_end / rate)]
    if scene.frame_start > 0:
        command += ["--from", str(scene.frame_start / rate)]
    if scene.camera:
        command += ["--camera", scene.camera.name]
    if settings.normalize:
        command += ["--lufs", str(settings.lufs)]
    if settings.stems:
        command += ["--stems", os.path.splitext(sound)[0] + "-stems"]
    return command


def put_on_timeline(scene, sound):
    """Puts the sound on a strip of its own, in place of the one before."""
    sequences = scene.sequence_editor_create().sequences
    old = sequences.get(STRIP)
    channel = old.channel if old else 1 + max((s.channel for s in sequences), default=0)
    if old:
        sequences.remove(old)
    for data in [s for s in bpy.data.sounds if s.users == 0 and os.path.realpath(bpy.path.abspath(s.filepath)) == os.path.realpath(sound)]:
        bpy.data.sounds.remove(data)
    strip = sequences.new_sound(STRIP, sound, channel, max(scene.frame_start, 0))
    strip.name = STRIP
    return strip


def not_keyed(scene):
    """Names of simulated bodies that have no keyframes, which an export holds still."""
    return [o.name for o in scene.objects if o.rigid_body and o.rigid_body.type == "ACTIVE" and not o.rigid_body.kinematic
            and not (o.animation_data and o.animation_data.action)]


class Run:
    """A command whose lines are read by a thread: fractions as progress, all others as messages."""

    def __init__(self, command):
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.lines, self.messages = queue.Queue(), []
        self.fraction, self.stage = 0.0, ""
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stdout:
            self.lines.put(line.rstrip())

    def take(self):
        while not self.lines.empty():
            line = self.lines.get()
            progress = re.fullmatch(r"([01]\.\d{3}) (.*)", line)
            if progress:
                self.fraction, self.stage = float(progress[1]), progress[2]
            elif line:
                self.messages.append(line)

    def ended(self):
        if self.process.poll() is None:
            return False
        self.reader.join()
        self.take()
        return True


class Work(bpy.types.Operator):
    """Base of both operators: exports, then runs commands one after the other."""
    bl_options = {"REGISTER"}

    def begin(self, context):
        self.scene = context.scene
        for name in not_keyed(self.scene):
            self.report({"WARNING"}, f"{name} is simulated and has no keyframes, so it stands still: "
                                     "Object > Rigid Body > Bake To Keyframes")
        path = file_beside(".glb")
        export(self.scene, path)
        self.left = self.commands(path)
        self.run = Run(self.left.pop(0))

    def step(self):
        """Whether more is to be done. Raises an error where a command has failed."""
        self.run.take()
        if not self.run.ended():
            return True
        code = self.run.process.returncode
        if code not in (0, EXIT_SILENCE):
            raise RuntimeError("; ".join(self.run.messages[-2:]) or f"the command ended with code {code}")
        for message in self.run.messages:
            self.report({"WARNING" if message.startswith("ringdown") else "INFO"}, message)
        if not self.left:
            return False
        self.run = Run(self.left.pop(0))
        return True

    def execute(self, context):
        try:
            self.begin(context)
            while self.step():
                self.run.reader.join(0.05)
            self.done()
        except (RuntimeError, OSError, subprocess.SubprocessError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}

    def invoke(self, context, _event):
        try:
            self.begin(context)
        except (RuntimeError, OSError, subprocess.SubprocessError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        result = {"PASS_THROUGH"}
        try:
            if event.type == "ESC":
                self.run.process.terminate()
                result = {"CANCELLED"}
            elif event.type == "TIMER" and not self.step():
                self.done()
                result = {"FINISHED"}
        except (RuntimeError, OSError, subprocess.SubprocessError) as error:
            self.report({"ERROR"}, str(error))
            result = {"CANCELLED"}
        over = result != {"PASS_THROUGH"}
        context.scene.ringdown.progress = 0 if over else 100 * self.run.fraction
        context.scene.ringdown.stage = "" if over else f"{self.bl_label}: {self.run.stage} (Esc ends)"
        if context.area:
            context.area.tag_redraw()
        if over:
            context.window_manager.event_timer_remove(self.timer)
        return result

    def done(self):
        pass


class RINGDOWN_OT_bake(Work):
    """Exports the scene, and computes how its objects ring"""
    bl_idname = "ringdown.bake"
    bl_label = "Bake"

    def commands(self, path):
        return [bake_command(self.scene, path)]


class RINGDOWN_OT_render_sound(Work):
    """Bakes what has changed, renders the sound of the animation and puts it on the sequencer's strip"""
    bl_idname = "ringdown.render_sound"
    bl_label = "Render sound"

    def commands(self, path):
        self.sound = file_beside(".wav")
        return [bake_command(self.scene, path), foley_command(self.scene, path, self.sound)]

    def done(self):
        put_on_timeline(self.scene, self.sound)


class RINGDOWN_PT_panel(bpy.types.Panel):
    bl_idname = "RINGDOWN_PT_panel"
    bl_label = "Ringdown"
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Ringdown"

    def draw(self, context):
        layout, settings = self.layout, context.scene.ringdown
        if context.object and context.object.type == "MESH":
            layout.prop(context.object, "ringdown_material")
        layout.prop(settings, "normalize")
        row = layout.row()
        row.enabled = settings.normalize
        row.prop(settings, "lufs")
        layout.prop(settings, "stems")
        if settings.stage:
            layout.label(text=settings.stage)
            layout.prop(settings, "progress", text="", slider=True)
            return
        layout.operator("ringdown.bake", icon="MOD_PHYSICS")
        layout.operator("ringdown.render_sound", icon="SOUND")


class RingdownSettings(bpy.types.PropertyGroup):
    normalize: bpy.props.BoolProperty(name="Set loudness", description="Give the sound a loudness by EBU R 128")
    lufs: bpy.props.FloatProperty(name="LUFS", default=-23, min=-70, max=0)
    stems: bpy.props.BoolProperty(
        name="Stems", description="Write a file for each object and kind of contact, too, beside the sound")
    progress: bpy.props.FloatProperty(subtype="PERCENTAGE", min=0, max=100, options={"SKIP_SAVE"})
    stage: bpy.props.StringProperty(options={"SKIP_SAVE"})


class RingdownPreferences(bpy.types.AddonPreferences):
    bl_idname = __name__
    program: bpy.props.StringProperty(
        name="Program", subtype="FILE_PATH", description="The program ringdown; empty: searched in PATH")

    def draw(self, _context):
        self.layout.prop(self, "program")


CLASSES = (RingdownSettings, RingdownPreferences, RINGDOWN_OT_bake, RINGDOWN_OT_render_sound, RINGDOWN_PT_panel)


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.ringdown = bpy.props.PointerProperty(type=RingdownSettings)
    bpy.types.Object.ringdown_material = bpy.props.StringProperty(
        name="Material", search=search_materials,
        description="What the object is made of; empty: told by the name of its ordinary material")


def unregister():
    del bpy.types.Object.ringdown_material
    del bpy.types.Scene.ringdown
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)


if __name__ == "__main__":
    register()
