"""The participant's heart: a process of its own that beats while the solver computes, and that ends
the participant when the coordinator is dead.

A thread of the participant could not do so: it needs the interpreter's lock, which a long call into
a C library (a factorisation, say) may hold for as long as it takes. The process shares a little
memory with the participant, the command that was dealt with last and how far the one is that is
worked on, and ends with it. A participant that is stopped (SIGSTOP, a debugger) has no heartbeat.

When the coordinator is dead the process tells the participant, a thread of which leaves the run in
order and ends the participant. One that holds the interpreter's lock does not come to that: it is
killed after `PATIENCE`, and its process leaves for it.
"""

from __future__ import annotations

import ctypes
import fcntl
import logging
import mmap
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import ClassVar

from .messages import Beat, ProgressReport
from .run_dir import Membership, RunInfo, leave_for
from .transport import Endpoint, ProgressSender, TransportError

#: From one beat, and one look at the coordinator, to the next [s].
INTERVAL = 0.05

#: How long the participant may take to leave a run whose coordinator is dead [s].
PATIENCE = 0.5

#: Stands for work on a command.
BUSY = 2**64 - 1

COORDINATOR_GONE = "the coordinator has ended; this run is over"

PR_SET_PDEATHSIG = 1

log = logging.getLogger(__name__)


class Shared(ctypes.Structure):
    """What the heart knows of the participant."""

    _fields_: ClassVar = [
        ("command", ctypes.c_uint64),
        # Reports are written in turn to the two places: the one that counts is not written to.
        ("reports", ctypes.c_uint64),
        ("report", ProgressReport * 2),
    ]

    def tell(self, report: ProgressReport) -> None:
        """Make this the newest report."""
        self.report[(self.reports + 1) % 2] = report
        self.reports += 1

    def newest(self) -> bytes:
        """The newest report; empty if there is a newer one already, or if it says nothing."""
        count = self.reports
        report = ProgressReport.from_buffer_copy(self.report[count % 2])
        says_something = report.done or report.of or report.what
        return bytes(report) if says_something and self.reports == count else b""


class Heart:
    """Beats until stopped."""

    def __init__(self, membership: Membership) -> None:
        shared = os.memfd_create("cosim-heart")
        os.ftruncate(shared, mmap.PAGESIZE)
        self._memory = mmap.mmap(shared, mmap.PAGESIZE)
        self._shared, self._sequence = Shared.from_buffer(self._memory), 0
        self._membership, self._stopping = membership, False
        self._news, tell = os.pipe()
        info = membership.info
        given = (info.folder, membership.index, shared, tell)
        self._process = subprocess.Popen(
            [sys.executable, "-m", "cosim.heart", *map(str, given)],
            stdin=subprocess.DEVNULL,
            pass_fds=[shared, tell],
        )
        os.close(shared)
        os.close(tell)
        self._thread = threading.Thread(target=self._watch, name="heart", daemon=True)
        self._thread.start()

    def busy(self, command: int) -> None:
        """The command with this number is being worked on."""
        self._sequence = command
        self._shared.tell(ProgressReport(command))
        self._shared.command = BUSY

    def report(self, done: int, of: int, what: str) -> None:
        """So much of the command that is worked on is done."""
        word = what.encode(errors="backslashreplace")[:31]
        self._shared.tell(ProgressReport(self._sequence, done, of, word))

    def idle_after(self, command: int) -> None:
        """The command with this number has been dealt with, and its reply, if any, sent."""
        self._shared.command = command

    def stop(self) -> None:
        """No beat comes after this returns."""
        self._stopping = True
        self._process.kill()
        self._process.wait()
        self._thread.join()
        os.close(self._news)

    def _watch(self) -> None:
        """End the participant, which may be deep in a solve, with the coordinator or the heart."""
        gone = os.read(self._news, 1)
        if self._stopping:
            return
        reason = COORDINATOR_GONE if gone else "the heartbeat has ended"
        # Nobody may be left to read it.
        with suppress(OSError):
            os.write(2, f"error: {reason}\n".encode())
        try:
            self._membership.leave()
        finally:
            os._exit(1)


def main(folder: Path, index: int, shared: int, tell: int) -> None:
    """Beat for the parent process until it ends."""
    parent = os.getppid()
    _end_with_parent(signal.SIGKILL)
    # Ctrl-C in a terminal is the coordinator's business.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    info = RunInfo.read(folder)
    coordinator = os.open(info.folder / "coordinator.lock", os.O_RDONLY)
    # `from_buffer` takes memory that may be written, though only the participant does.
    told = Shared.from_buffer(mmap.mmap(shared, mmap.PAGESIZE))
    endpoint = Endpoint(info)
    ringer = endpoint.ringer("coordinator")
    reports, reported = endpoint.progress_sender(info.roles[index]), b""
    while os.getppid() == parent:
        if _is_free(coordinator):
            _end(parent, info, tell)
        command = told.command
        beat = Beat.BUSY if command == BUSY else Beat.idle_after(command)
        if not _is_stopped(parent):
            try:
                reported = _offer(reports, told.newest(), reported)
                ringer.beat(index, beat)
            except TransportError as error:
                log.warning("the heartbeat does not reach the coordinator: %s", error)
        time.sleep(INTERVAL)


def _offer(reports: ProgressSender, newest: bytes, reported: bytes) -> bytes:
    """Send the newest report if it is news; the one that has arrived last."""
    news = newest and newest != reported
    arrived = news and reports.offer(ProgressReport.from_buffer_copy(newest))
    return newest if arrived else reported


def _end_with_parent(signal_number: int) -> None:
    ctypes.CDLL(None, use_errno=True).prctl(PR_SET_PDEATHSIG, signal_number, 0, 0, 0)


def _is_free(lock: int) -> bool:
    try:
        fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return False
    fcntl.flock(lock, fcntl.LOCK_UN)
    return True


def _is_stopped(process: int) -> bool:
    try:
        # The state stands behind the name, which is in parentheses.
        status = Path(f"/proc/{process}/stat").read_bytes().rpartition(b")")[2].split()
    except OSError:
        return True
    return status[0] in (b"T", b"t")


def _end(participant: int, info: RunInfo, tell: int) -> None:
    """Let the participant leave the run, or leave it in order for one that does not."""
    os.write(tell, b"x")
    time.sleep(PATIENCE)
    with suppress(OSError):
        os.write(2, f"error: {COORDINATOR_GONE}\n".encode())
    _end_with_parent(0)
    with suppress(ProcessLookupError):
        os.kill(participant, signal.SIGKILL)
    while os.getppid() == participant:
        time.sleep(0.001)
    leave_for(info)
    os._exit(1)


if __name__ == "__main__":
    _, folder, index, shared, tell = sys.argv
    main(Path(folder), int(index), int(shared), int(tell))
