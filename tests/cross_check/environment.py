"""Foreign packages for the cross-checks, without touching the user's Python."""

import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path


def run_with(*requirements):
    """Returns in an interpreter that has `requirements` from PyPI; from another it starts the script again in one.

    The virtual environment is $CROSS_CHECK_VENV, or a temporary folder that later runs use again.
    """
    if os.environ.get("CROSS_CHECK_INSIDE"):
        return
    folder = Path(os.environ.get("CROSS_CHECK_VENV") or Path(tempfile.gettempdir()) / "calipose-cross-check")
    python = folder / "bin" / "python"
    if not python.exists():
        venv.create(folder, with_pip=True)
    subprocess.run([python, "-m", "pip", "install", "--quiet", *requirements], check=True)
    environment = os.environ | {"CROSS_CHECK_INSIDE": "1"}
    sys.exit(subprocess.run([python, *sys.argv], env=environment).returncode)
