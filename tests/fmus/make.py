"""Makes an FMU of one of the models in this folder: compiled by `cc`, packed with its description.

    python3 make.py MODEL FILE.fmu [OLD NEW ...]

OLD and NEW are texts of the description, the second of which comes in the place of the first.
"""

import platform
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent


def make(model, path, changes=()):
    """Writes the FMU of a model; its description with texts replaced by others."""
    description = (HERE / model / "modelDescription.xml").read_text()
    for old, new in changes:
        assert old in description, old
        description = description.replace(old, new)
    two = 'fmiVersion="2.0"' in description
    place = "linux64" if two else f"{platform.machine()}-linux"
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / f"{model}.so"
        options = ["-std=c11", "-O2", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function", "-fPIC", "-shared"]
        # The same bits on every machine: no multiplication is fused with an addition.
        command = ["cc", *options, "-ffp-contract=off", str(HERE / model / "model.c"), "-o", str(library), "-lm"]
        subprocess.run(command, check=True)
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as fmu:
            fmu.writestr("modelDescription.xml", description)
            fmu.write(library, f"binaries/{place}/{model}.so")
    return path


if __name__ == "__main__":
    words = sys.argv[3:]
    make(sys.argv[1], sys.argv[2], list(zip(words[::2], words[1::2], strict=True)))
