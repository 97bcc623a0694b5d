"""The LV2 plug-in in Ardour: a session that a script makes, with a track of three notes, is exported by Ardour's own tool.

Skipped where Ardour 7 is not installed."""

import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SKIPPED = 77
BUNDLE = Path(os.environ["RINGDOWN_BUNDLE"])
RATE_HZ = 48000
BEAT = 960  # ticks; half a second
NOTES = [(1, 60), (2, 64), (3, 67)]  # beat and key

MAKE = """
AudioEngine:set_backend("None (Dummy)", "", "")
local session = create_session(FOLDER, "notes", 48000)
local plugin = ARDOUR.LuaAPI.new_plugin_info("urn:ringdown:instrument", ARDOUR.PluginType.LV2)
local midi, stereo = ARDOUR.DataType("midi"), ARDOUR.DataType("audio")
local tracks = session:new_midi_track(ARDOUR.ChanCount(midi, 1), ARDOUR.ChanCount(stereo, 2), true, plugin, nil, nil, 1,
  "bell", ARDOUR.PresentationInfo.max_order, ARDOUR.TrackMode.Normal, true, false)
for track in tracks:iter() do
  for c = 0, 1 do track:output():audio(c):connect("Master/audio_in " .. (c + 1)) end
end
session:save_state("", false, false, false, false, false)
close_session()
quit()
"""

REGION = (
    '<Region name="notes" whole-file="{whole}" start="b0" length="b7680@b0" sync-position="a0" ancestral-start="b0" '
    'ancestral-length="b0@b0" muted="0" opaque="1" id="{id}" type="midi" source-0="9000" master-source-0="9000" channels="1"/>'
)


def variable(number: int) -> bytes:
    """A number as MIDI files have it, seven bits to a byte."""
    parts = [number & 127]
    while number := number >> 7:
        parts.insert(0, number & 127 | 128)
    return bytes(parts)


def midi_file() -> bytes:
    messages = [(beat * BEAT, bytes([0x90, key, 100])) for beat, key in NOTES]
    messages += [(beat * BEAT + BEAT - 60, bytes([0x80, key, 64])) for beat, key in NOTES]
    events, last = b"", 0
    for tick, message in sorted(messages):
        events += variable(tick - last) + message
        last = tick
    events += b"\0\xff\x2f\0"
    return b"MThd" + struct.pack(">IHHH", 6, 0, 1, BEAT) + b"MTrk" + struct.pack(">I", len(events)) + events


def add_notes(session: Path) -> None:
    """Puts the MIDI file into the session, as a region of its only track."""
    (session / "interchange" / "notes" / "midifiles" / "notes.mid").write_bytes(midi_file())
    file = session / "notes.ardour"
    text = file.read_text()
    text = text.replace("<Sources/>", '<Sources><Source name="notes.mid" type="midi" flags="Writable" id="9000"/></Sources>')
    text = text.replace("<Regions/>", "<Regions>" + REGION.format(whole=1, id=9001) + "</Regions>")
    text = re.sub(r'(<Playlist [^>]*name="bell"[^>]*)/>', r"\1>" + REGION.format(whole=0, id=9002) + "</Playlist>", text)
    end = 282240000 * 5  # superclocks: 5 s
    text = text.replace("<Locations/>", f'<Locations><Location id="9003" name="session" start="a0" end="a{end}" flags="IsSessionRange"/></Locations>')
    file.write_text(text)


class Ardour(unittest.TestCase):
    def test_a_session_plays_its_notes_on_time_and_in_tune(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            home = Path(folder)
            shutil.copytree(BUNDLE, home / ".lv2" / "ringdown.lv2")
            environment = dict(os.environ, HOME=folder, XDG_CONFIG_HOME=folder, LV2_PATH=str(home / ".lv2"))

            def run(*command: str) -> str:
                done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                return done.stdout + done.stderr

            script, session, sound = home / "make.lua", home / "notes", home / "sound.wav"
            script.write_text(MAKE.replace("FOLDER", f'"{session}"'))
            run("ardour7-lua", str(script))
            add_notes(session)
            said = run("ardour7-export", "-b", "float", "-o", str(sound), str(session), "notes")
            self.assertNotIn("Ringdown:", said)  # which complains on standard error
            raw = sound.read_bytes()
            left = np.frombuffer(raw[raw.index(b"data") + 8 :], "<f4")[::2].astype(float)
        begins = [beat * RATE_HZ // 2 for beat, _ in NOTES]
        self.assertLess(abs(np.flatnonzero(np.abs(left) > 1e-5)[0] - begins[0]), 3)
        pitches = []
        for begin in begins:
            after, before = (left[start : start + 20000] * np.hanning(20000) for start in (begin + 200, begin - 20200))
            spectrum = np.abs(np.fft.rfft(after, 1 << 19))
            pitches.append(spectrum.argmax())
            self.assertGreater(spectrum.max(), 10 * np.abs(np.fft.rfft(before, 1 << 19))[spectrum.argmax()])
        for (_, key), pitch in zip(NOTES, pitches):
            cents = 1200 * np.log2(pitch / pitches[0]) - 100 * (key - NOTES[0][1])
            self.assertLess(abs(cents), 1)


try:
    import numpy as np
except ModuleNotFoundError:
    np = None

if __name__ == "__main__":
    if np is None or not shutil.which("ardour7-export"):
        print("skipped: Ardour 7 or python3-numpy is not installed")
        sys.exit(SKIPPED)
    unittest.main()
