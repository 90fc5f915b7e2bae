#!/usr/bin/env python
"""The command `coordinator` of a wheel that contains the executables: replaces itself by the
executable inside."""

import os
import sys
from importlib.util import find_spec
from pathlib import Path

# The package is located without importing it, because the import takes longer than a small case.
package = find_spec("cosim")
if package is None or package.origin is None:
    sys.exit("error: the package `cosim` is missing; reinstall its wheel")
os.execv(Path(package.origin).with_name("bin") / "coordinator", sys.argv)
