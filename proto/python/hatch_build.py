"""Adds the executables of a release to the wheel, if COSIM_EXECUTABLES names the build folder.

    cargo build --release --workspace --features tests/complete
    COSIM_EXECUTABLES=$PWD/target/release pip wheel --no-deps ./proto/python -w dist

Such a wheel is specific to a platform and has a command `coordinator`. A wheel without executables
is portable and finds them elsewhere. The file `release/programs` lists the executables.
"""

import os
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

LIST = Path("../../release/programs")
BUILD = "cargo build --release --workspace --features tests/complete"


class Executables(BuildHookInterface[Any]):
    """Build hook of this package's `pyproject.toml`."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the executables, except to editable installations and source distributions."""
        folder = os.environ.get("COSIM_EXECUTABLES")
        if not folder or version == "editable" or self.target_name != "wheel":
            return
        root = Path(self.root)
        for name in (root / LIST).read_text().split():
            path = Path(folder) / name
            if not path.is_file():
                raise FileNotFoundError(f"{path}: run `{BUILD}` first")
            build_data["force_include"][str(path)] = f"cosim/bin/{name}"
        build_data["shared_scripts"][str(root / "coordinator.py")] = "coordinator"
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{platform}"
