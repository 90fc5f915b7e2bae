"""Creates `target/python-env` with this package, and prints the path of its interpreter.

    python3 proto/python/environment.py [--test]

`--test` adds the test requirements, pytest and a VTK reader. The environment is created once and
updated when the package has changed; concurrent calls wait for each other. If `venv` lacks
`ensurepip` (a bare Debian), the packages go into a folder, and the printed interpreter is a wrapper
that uses this folder. If `COSIM_PYTHON` names an interpreter, that path is printed as it is.
"""

import fcntl
import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", PACKAGE.parent.parent / "target"))
FOLDER = TARGET / "python-env"
PYTHON = FOLDER / "bin" / "python"

ADVICE = (
    "error: the Python environment for the tests cannot be made. It needs Python 3.11 with venv or "
    "pip (Debian: apt-get install python3-venv python3-pip) and access to a package index. Or name "
    "a ready interpreter, COSIM_PYTHON=/path/to/python, after `python -m pip install 'proto/python[test]'`"
)


def main() -> None:
    """Create or update the environment."""
    wanted = ".[test]" if "--test" in sys.argv[1:] else "."
    ready = os.environ.get("COSIM_PYTHON")
    if ready:
        print(ready)
        return
    TARGET.mkdir(parents=True, exist_ok=True)
    with (TARGET / "python-env.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        state = fingerprint()
        # An environment with the test requirements serves all purposes.
        stamps = [FOLDER / f"stamp{kind}" for kind in (wanted, ".[test]")]
        if not any(stamp.exists() and stamp.read_text() == state for stamp in stamps):
            make(wanted)
            stamps[0].write_text(state)
    print(PYTHON)


def fingerprint() -> str:
    """Return a hash of the inputs of the environment."""
    digest = hashlib.sha256(sys.version.encode())
    for path in [PACKAGE / "pyproject.toml", *sorted(PACKAGE.glob("src/**/*.py"))]:
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()


def make(wanted: str) -> None:
    """Install the package and its requirements; exit with advice on failure."""
    try:
        if (FOLDER / "packages").exists() or not (PYTHON.exists() or make_venv()):
            install_into_folder(wanted)
        else:
            pip([PYTHON, "-m", "pip"], "--force-reinstall", "--no-deps", str(PACKAGE))
            pip([PYTHON, "-m", "pip"], f"{PACKAGE}{wanted[1:]}")
    except subprocess.CalledProcessError as error:
        sys.exit(f"{error}\n{ADVICE}")


def make_venv() -> bool:
    """Create a virtual environment; return false if this Python cannot."""
    shutil.rmtree(FOLDER, ignore_errors=True)
    done = subprocess.run([sys.executable, "-m", "venv", FOLDER], check=False, capture_output=True)
    return done.returncode == 0


def install_into_folder(wanted: str) -> None:
    """Install packages into a folder, and write a wrapper that uses this folder."""
    shutil.rmtree(FOLDER, ignore_errors=True)
    packages = FOLDER / "packages"
    packages.mkdir(parents=True)
    pip([sys.executable, "-m", "pip"], "--target", str(packages), f"{PACKAGE}{wanted[1:]}")
    PYTHON.parent.mkdir()
    path = f"{packages}${{PYTHONPATH:+:$PYTHONPATH}}"
    PYTHON.write_text(f'#!/bin/sh\nPYTHONPATH="{path}" exec "{sys.executable}" "$@"\n')
    PYTHON.chmod(0o755)


def pip(command: list[str | Path], *what: str) -> None:
    """Run pip, with its output on standard error."""
    options = ["install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*command, *options, *what], check=True, stdout=sys.stderr)


if __name__ == "__main__":
    main()
