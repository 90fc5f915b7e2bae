"""Puts the executables into the wheel, where COSIM_EXECUTABLES names their folder.

    cargo build --release
    COSIM_EXECUTABLES=$PWD/target/release pip wheel --no-deps ./proto/python -w dist

Such a wheel is of a platform; without them it is of any, and finds the executables elsewhere.
"""

import os
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

NAMES = ("coordinator", "mech-solver", "thermal-solver")


class Executables(BuildHookInterface):
    """The hook of this package's `pyproject.toml`."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the executables; of an editable installation and of sources none."""
        folder = os.environ.get("COSIM_EXECUTABLES")
        if not folder or version == "editable" or self.target_name != "wheel":
            return
        for name in NAMES:
            path = Path(folder) / name
            if not path.is_file():
                raise FileNotFoundError(f"{path}: run `cargo build --release` first")
            build_data["force_include"][str(path)] = f"cosim/bin/{name}"
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{platform}"
