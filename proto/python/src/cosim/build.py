"""Build of a Python participant: a digest of the files that it consists of.

A script may be edited under the same version, and so may the modules that it imports. The digest
covers the interpreter's version, all modules that are loaded outside of the standard library, and
the library of the contract. Modules that are imported later and data that a program reads by itself
are not covered. A solver that knows better states `build` in its `description`.
"""

from __future__ import annotations

import functools
import hashlib
import sys
import sysconfig
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from types import ModuleType


@functools.cache
def build(*further: str) -> str:
    """Return the digest of the loaded modules and of further files.

    The first answer stays, because all descriptions of a process are the same.
    """
    found = [sys.version]
    for path in {*sources(list(sys.modules.values())), *further}:
        with suppress(OSError), Path(path).open("rb") as file:
            # Names without folders: the same files elsewhere are the same build.
            found.append(f"{Path(path).name} {hashlib.file_digest(file, 'blake2b').hexdigest()}")
    return hashlib.blake2b("\n".join(sorted(found)).encode(), digest_size=8).hexdigest()


def sources(modules: Iterable[ModuleType | None]) -> set[str]:
    """Return the files of modules outside of the standard library."""
    standard = tuple(sysconfig.get_path(name) + "/" for name in ("stdlib", "platstdlib"))
    named = (getattr(module, "__file__", None) for module in modules)
    files = {name for name in named if isinstance(name, str)}
    return {one for one in files if not one.startswith(standard) or "-packages/" in one}
