"""The Debian package ringdown-plugin: what is in it, what it needs, and that it unpacks, loads and goes again.

package_test.py BUILD: makes the package of the plug-in that is built there. dpkg unpacks it into a folder of its own
beside this system's libraries; packaging/fresh_debian.sh installs it in a fresh Debian."""

import ctypes
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
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
        done("cpack", "-G", "DEB", "-D", "CPACK_COMPONENTS_ALL=ringdown-plugin", "-B", cls.folder / "made",
             "--config", BUILD / "CPackConfig.cmake", cwd=BUILD)
        packages = list((cls.folder / "made").glob("*.deb"))
        assert len(packages) == 1, packages
        cls.package = packages[0]

    def test_holds_the_three_formats_and_their_licences_and_nothing_else(self):
        lines = done("dpkg-deb", "-c", self.package).splitlines()
        files = {line.split()[5].lstrip(".") for line in lines if line.startswith("-")}
        machine = os.uname().machine
        self.assertEqual(files, {
            "/usr/lib/clap/ringdown.clap",
            f"/usr/lib/vst3/ringdown.vst3/Contents/{machine}-linux/ringdown.so",
            "/usr/lib/lv2/ringdown.lv2/ringdown.so",
            "/usr/lib/lv2/ringdown.lv2/manifest.ttl",
            "/usr/lib/lv2/ringdown.lv2/presets.ttl",
            "/usr/lib/lv2/ringdown.lv2/ringdown.ttl",
            "/usr/lib/lv2/ringdown.lv2/ringdown_ui.so",
            "/usr/lib/lv2/ringdown.lv2/ringdown_ui.ttl",
            "/usr/share/doc/ringdown-plugin/copyright",
            "/usr/share/doc/ringdown-plugin/copyright-dpf",
        })
        self.assertTrue(all(line.split()[1] == "root/root" for line in lines))

    def test_needs_a_few_libraries_that_any_host_may_link(self):
        needs = done("dpkg-deb", "-f", self.package, "Depends")
        names = {part.split()[0] for part in needs.replace("|", ",").split(",") if part.strip()}
        self.assertLessEqual(names, MAY_NEED)
        self.assertIn("libc6", names)
        self.assertRegex(done("dpkg-deb", "-f", self.package, "Recommends"), r"^ringdown \(= ")

    @unittest.skipUnless(os.geteuid() == 0, "dpkg installs as root")
    def test_unpacks_loads_and_leaves_nothing_behind(self):
        root = self.folder / "root"
        (root / "var/lib/dpkg/info").mkdir(parents=True)
        (root / "var/lib/dpkg/updates").mkdir()
        (root / "var/lib/dpkg/status").touch()
        done("dpkg", f"--root={root}", "--unpack", self.package)  # its script calls ldconfig, which is not in this root
        binaries = [path for path in root.rglob("ringdown.*") if path.suffix in (".so", ".clap")]
        self.assertEqual(len(binaries), 3)
        for path, entry in zip(sorted(binaries), ("clap_entry", "lv2_descriptor", "GetPluginFactory")):
            self.assertNotIn("not found", done("ldd", path))
            self.assertTrue(getattr(ctypes.CDLL(str(path)), entry))
        if shutil.which("lv2ls"):
            listed = done("lv2ls", env={**os.environ, "LV2_PATH": str(root / "usr/lib/lv2")})
            self.assertEqual(len(listed.split()), 1, listed)
        (root / "var/lib/dpkg/info/ringdown-plugin.postrm").unlink()
        done("dpkg", f"--root={root}", "-P", "ringdown-plugin")
        self.assertFalse([path for path in root.rglob("*ringdown*") if path.is_file()])


if not all(map(shutil.which, ("cpack", "dpkg-deb", "dpkg-shlibdeps", "ldd"))):
    print("cpack or dpkg's tools are not installed")
    sys.exit(SKIPPED)
unittest.main()
