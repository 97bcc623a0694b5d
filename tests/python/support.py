"""What the tests of the Python module share: where things are, and a bank that is read without Ringdown."""

import os
import sys
from pathlib import Path

SOURCE = Path(os.environ["RINGDOWN_SOURCE_DIR"])
BUILD = Path(os.environ["RINGDOWN_BUILD_DIR"])
PROGRAMS = BUILD / "bin"
BANKS = SOURCE / "presets" / "banks"
SKIPPED = 77

sys.path += [str(SOURCE / "tests" / "support"), str(SOURCE / "clients" / "python")]  # bank_document, strike


def skip(why):
    """Ends this test program as ctest's skipped."""
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


try:
    import numpy  # noqa: F401
except ModuleNotFoundError:
    skip("python3-numpy is not installed")
