"""The Debian package ringdown-plugin: what is in it, what it needs, and that it loads.

package_test.py SOURCE BUILD: installs the plug-in that is built there into a folder, as debian/rules does;
packaging/fresh_debian.sh installs the package in a fresh Debian."""

import ctypes
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE, BUILD = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(2))
SKIPPED = 77
# Neither JACK, ODE nor anything under the GPL.
MAY_NEED = {"libc6", "libfmt9", "libgcc-s1", "libstdc++6", "libhwy1", "libkissfft-float131", "libmeshoptimizer2d", "libmysofa1"}
MAY_NEED |= {"libepoxy0", "libfontconfig1", "libgl1", "libpng16-16", "libstb0", "libx11-6"}  # the window


def done(*command, **settings):
    made = subprocess.run([str(part) for part in command], capture_output=True, text=True, **settings)
    assert made.returncode == 0, f"{command}: {made.stdout}{made.stderr}"
    return made.stdout


class PluginPackage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="ringdown-package-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.root = cls.folder / "debian/ringdown-plugin"
        cls.root.mkdir(parents=True)
        shutil.copy(SOURCE / "debian/control", cls.folder / "debian/control")
        done("cmake", "--install", BUILD, "--component", "ringdown-plugin", "--prefix", "/usr",
             env={**os.environ, "DESTDIR": str(cls.root)})
        cls.binaries = sorted(path for path in cls.root.rglob("ringdown*") if path.suffix in (".so", ".clap") and path.is_file())

    def test_holds_the_three_formats_and_a_licence_and_nothing_else(self):
        machine = os.uname().machine
        self.assertEqual({f"/{path.relative_to(self.root)}" for path in self.root.rglob("*") if path.is_file()}, {
            "/usr/lib/clap/ringdown.clap",
            f"/usr/lib/vst3/ringdown.vst3/Contents/{machine}-linux/ringdown.so",
            "/usr/lib/lv2/ringdown.lv2/ringdown.so",
            "/usr/lib/lv2/ringdown.lv2/manifest.ttl",
            "/usr/lib/lv2/ringdown.lv2/presets.ttl",
            "/usr/lib/lv2/ringdown.lv2/ringdown.ttl",
            "/usr/lib/lv2/ringdown.lv2/ringdown_ui.so",
            "/usr/lib/lv2/ringdown.lv2/ringdown_ui.ttl",
            "/usr/share/doc/ringdown-plugin/copyright-dpf",
        })

    def test_needs_a_few_libraries_that_any_host_may_link(self):
        needs = done("dpkg-shlibdeps", "-O", *self.binaries, cwd=self.folder)
        names = {part.split()[0] for part in needs.strip().split("=", 1)[1].replace("|", ",").split(",")}
        self.assertLessEqual(names, MAY_NEED)
        self.assertIn("libc6", names)

    def test_loads(self):
        entries = {"clap": "clap_entry", "lv2": "lv2_descriptor", "vst3": "GetPluginFactory"}
        modules = [path for path in self.binaries if path.stem == "ringdown"]
        self.assertEqual(len(modules), 3)
        for path in modules:
            self.assertNotIn("not found", done("ldd", path))
            entry = next(entry for name, entry in entries.items() if f"/lib/{name}/" in str(path))
            self.assertTrue(getattr(ctypes.CDLL(str(path)), entry))
        if shutil.which("lv2ls"):
            listed = done("lv2ls", env={**os.environ, "LV2_PATH": str(self.root / "usr/lib/lv2")})
            self.assertEqual(len(listed.split()), 1, listed)


if not all(map(shutil.which, ("dpkg-shlibdeps", "ldd"))):
    print("dpkg's tools are not installed")
    sys.exit(SKIPPED)
unittest.main()
