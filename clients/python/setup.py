"""The two extension modules. They need libringdown's C headers and libraries: those that pkg-config knows, or those in
the folders RINGDOWN_INCLUDE_DIR and RINGDOWN_LIBRARY_DIR, for a library that is built and not installed."""

import os
import subprocess

from pybind11.setup_helpers import Pybind11Extension
from setuptools import setup


def folders(option, prefix):
    try:
        found = subprocess.run(
            ["pkg-config", option, "ringdown", "ringdown-scene"], capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError) as failure:
        raise SystemExit(
            "pkg-config does not find libringdown: install the package libringdown-dev, or set RINGDOWN_INCLUDE_DIR and "
            "RINGDOWN_LIBRARY_DIR to the folders of its headers and libraries"
        ) from failure
    return [word[len(prefix) :] for word in found.stdout.split() if word.startswith(prefix)]


include, library = os.environ.get("RINGDOWN_INCLUDE_DIR"), os.environ.get("RINGDOWN_LIBRARY_DIR")
include_dirs = [include] if include else folders("--cflags-only-I", "-I")
library_dirs = [library] if library else folders("--libs-only-L", "-L")


def extension(name, sources, libraries):
    return Pybind11Extension(
        f"ringdown.{name}",
        [f"source/{source}" for source in sources],
        cxx_std=17,
        include_dirs=["source", *include_dirs],
        library_dirs=library_dirs,
        runtime_library_dirs=[library] if library else [],
        libraries=libraries,
        depends=["source/channels.h", "source/ringdown_python.h"],
    )


setup(
    ext_modules=[
        extension("_core", ["core.cpp", "mixer.cpp"], ["ringdown"]),
        extension("_scene", ["scene.cpp"], ["ringdown-scene", "ringdown"]),
    ]
)
