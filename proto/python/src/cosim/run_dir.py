"""A run's folder and its locks; which processes live, and which cleans up.

The kernel drops advisory locks with their holder, however it ends (`proto/src/run_dir.rs`):

- `coordinator.lock`, exclusive: a participant that can take it knows that the coordinator is dead;
- `participant-ROLE.lock`, exclusive: the coordinator knows when a participant is gone;
- `members.lock`, shared by all: the process that can take it exclusively is the last, and removes
  the folder and every shared-memory file with the run's prefix.
"""

from __future__ import annotations

import fcntl
import json
import os
import re
import shutil
import threading
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from .messages import PROTOCOL_VERSION

SHARED_MEMORY = Path("/dev/shm")


class RunError(Exception):
    """A run that cannot be joined."""


@dataclass(frozen=True)
class RunInfo:
    """The content of `run.json` in the run's folder."""

    folder: Path
    """Folder of the run; the root path of all its services."""
    prefix: str
    """Prefix of all its shared-memory files."""
    roles: tuple[str, ...]
    """Roles of the participants; the index numbers their heartbeats."""

    @classmethod
    def read(cls, folder: Path) -> RunInfo:
        """Read the run's file; raises `RunError` if there is none that this package speaks."""
        try:
            value = json.loads((folder / "run.json").read_bytes())
            protocol, prefix = value["protocol"], value["prefix"]
            info = cls(Path(value["folder"]), prefix, tuple(value["roles"]))
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise RunError(f"no run at {folder}: {error!r}") from error
        if protocol != PROTOCOL_VERSION:
            raise RunError(
                f"the coordinator speaks protocol {protocol}, this package {PROTOCOL_VERSION}"
            )
        info._check_place(folder)
        return info

    def _check_place(self, folder: Path) -> None:
        """Raise `RunError` for a run of another user, or one that names what is not its own.

        The last to leave removes what the run's file names.
        """
        try:
            here, named = folder.stat(), self.folder.stat()
        except OSError as error:
            raise RunError(f"no run at {folder}: {error}") from error
        if here.st_uid != os.geteuid():
            raise RunError(f"the run at {folder} belongs to another user")
        same = os.path.samestat(here, named) and self.prefix == f"cosim_{self.folder.name}_"
        if not same or not re.fullmatch("[0-9a-f]{8}", self.folder.name):
            raise RunError(
                f"{folder / 'run.json'} is not that of a run: folder {self.folder} and prefix "
                f"{self.prefix!r} do not belong to it"
            )


class Membership:
    """Membership in a run: holds the locks, and cleans up when the last member leaves."""

    def __init__(self, folder: Path, role: str) -> None:
        self.info = info = RunInfo.read(folder)
        if role not in info.roles:
            known = ", ".join(info.roles)
            raise RunError(f"the run has no role `{role}`; it has {known}")
        self.index = info.roles.index(role)
        self._leaving = threading.Lock()
        self._left = False
        try:
            self._members = os.open(info.folder / "members.lock", os.O_RDONLY)
            if not _lock(self._members, fcntl.LOCK_SH):
                raise RunError(f"the run at {folder} is over")
            flags = os.O_RDWR | os.O_CREAT | os.O_TRUNC
            self._own = os.open(info.folder / f"participant-{role}.lock", flags, 0o644)
        except OSError as error:
            raise RunError(f"no run at {folder}: {error}") from error
        if not _lock(self._own, fcntl.LOCK_EX):
            raise RunError(
                f"another process plays the role `{role}` in this run; of several that are started "
                "as one participant (MPI ranks) only one joins (docs/write-a-solver.md)"
            )

    def leave(self) -> None:
        """Leave the run; the last member removes its folder and its shared memory."""
        with self._leaving:
            if self._left:
                return
            self._left = True
            for lock in (self._own, self._members):
                with suppress(OSError):
                    fcntl.flock(lock, fcntl.LOCK_UN)
            _remove_if_last(self.info, self._members)


def leave_for(info: RunInfo) -> None:
    """What the last member of a run does, for one that has been killed."""
    try:
        members = os.open(info.folder / "members.lock", os.O_RDONLY)
    except OSError:
        # It was the last, and was killed while it removed them.
        _remove(info)
    else:
        _remove_if_last(info, members)


def _remove_if_last(info: RunInfo, members: int) -> None:
    if _lock(members, fcntl.LOCK_EX):
        _remove(info)


def _lock(file: int, operation: int) -> bool:
    try:
        fcntl.flock(file, operation | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _remove(info: RunInfo) -> None:
    for entry in SHARED_MEMORY.glob(f"{info.prefix}*"):
        with suppress(OSError):
            entry.unlink()
    shutil.rmtree(info.folder, ignore_errors=True)
    # Succeeds only for the last run.
    with suppress(OSError):
        info.folder.parent.rmdir()


def peak_resident_memory() -> int:
    """Largest resident memory of this process so far [byte]; 0 where it cannot be known."""
    with suppress(OSError, ValueError):
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) * 1024
    return 0


def forget_peak_resident_memory() -> None:
    """Let `peak_resident_memory` begin anew, where the system can."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
