#!/usr/bin/env python
"""The command `coordinator` of a wheel that has the executables inside: it becomes the one in there."""

import os
import sys
from importlib.util import find_spec
from pathlib import Path

# The package is found, and not imported: that would take longer than a small case does.
package = find_spec("cosim")
if package is None or package.origin is None:
    sys.exit("error: the package `cosim` is not there any more; install its wheel again")
os.execv(Path(package.origin).with_name("bin") / "coordinator", sys.argv)
