"""Values of a model's points on disk, in one file per content of a case.

Each line holds one point: a check sum, then the numbers of the point and its values as JSON. The
check sum includes the name of the file, which is the hash of all that determines the values. A line
that is cut, damaged, or of another case or version is therefore ignored. Writers lock the file and
append whole lines, so several processes can share it.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import stat
from collections.abc import Iterable
from pathlib import Path
from typing import BinaryIO

import numpy as np

from .series import Array

CHECK = 16
"""Length of a check sum [hexadecimal digit]."""


class Cache:
    """Values of points of one content, read as far as other processes have written them."""

    def __init__(self, folder: Path, content: str) -> None:
        self._path, self._content, self._read = folder / f"{content}.jsonl", content, 0

    def news(self, sizes: tuple[int, int]) -> list[tuple[Array, Array]]:
        """Return points and values written since the last call, if both have these sizes.

        Raises `OSError` if the file is a folder, a pipe or a device.
        """
        try:
            with self._open(os.O_RDONLY) as file:
                file.seek(self._read)
                data = file.read()
        except (FileNotFoundError, NotADirectoryError):
            return []
        whole = data[: data.rfind(b"\n") + 1]
        self._read += len(whole)
        found = (self._parse(line) for line in whole.splitlines())
        return [one for one in found if one and tuple(map(len, one)) == sizes]

    def add(self, rows: Iterable[tuple[Array, Array]]) -> None:
        """Append points and their values."""
        texts = [json.dumps([point.tolist(), values.tolist()]) for point, values in rows]
        lines = "".join(f"{self._check(text)} {text}\n" for text in texts)
        if not lines:
            return
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._open(os.O_WRONLY | os.O_APPEND | os.O_CREAT) as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            # A line that was cut must not spoil the next one.
            size = os.fstat(file.fileno()).st_size
            os.write(file.fileno(), b"\n" * (size > 0) + lines.encode())

    def _open(self, mode: int) -> BinaryIO:
        """Open the file without waiting for the other end of a pipe."""
        file = os.open(self._path, mode | os.O_NONBLOCK | os.O_CLOEXEC, 0o666)
        if not stat.S_ISREG(os.fstat(file).st_mode):
            os.close(file)
            raise OSError(f"{self._path} is not a regular file; remove it, or pass cache=False")
        return os.fdopen(file, "ab" if mode & os.O_APPEND else "rb", buffering=0)

    def _parse(self, line: bytes) -> tuple[Array, Array] | None:
        check, _, text = line.decode("ascii", "replace").partition(" ")
        if check != self._check(text):
            return None
        try:
            point, values = (np.array(one, float) for one in json.loads(text))
        except (ValueError, TypeError, RecursionError):
            return None
        return (point, values) if point.ndim == values.ndim == 1 else None

    def _check(self, text: str) -> str:
        return hashlib.sha256(f"{self._content} {text}".encode()).hexdigest()[:CHECK]
