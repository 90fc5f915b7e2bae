"""The participant's heart: a thread that beats while the solver computes, and that ends the process
when the coordinator is dead.

It needs the interpreter's lock for some microseconds every `INTERVAL`. numpy's loops, FFTs, linear
algebra and file access let go of it, and pure Python code does every few milliseconds. What keeps
it is a single long call into an extension that never lets go: sorting a huge Python list, one
regular expression over a large text, big-integer arithmetic, `ctypes.PyDLL`, numpy on arrays of
objects. A solver whose calls of that kind last longer than `coupling.heartbeat_deadline` (30 s
unless the case says otherwise) is taken for dead: call such code in pieces, or through
`ctypes.CDLL`, which lets go.
"""

from __future__ import annotations

import logging
import os
import threading
from contextlib import suppress
from typing import NoReturn

from .run_dir import Membership
from .transport import Ringer, TransportError

#: From one beat, and one look at the coordinator, to the next [s].
INTERVAL = 0.05

log = logging.getLogger(__name__)


class Pulse:
    """Beats until stopped."""

    def __init__(self, ringer: Ringer, membership: Membership) -> None:
        self._ringer, self._membership = ringer, membership
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="pulse", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """No beat comes after this returns."""
        self._stop.set()
        self._thread.join()

    def _run(self) -> None:
        try:
            self._beat()
        except BaseException as error:
            # Without its heart the process would outlive a coordinator that dies.
            self._end(f"the heart has stopped: {error!r}")

    def _beat(self) -> None:
        while not self._stop.wait(INTERVAL):
            if not self._membership.coordinator_lives():
                self._end("the coordinator is gone; this run is over")
            try:
                self._ringer.beat(self._membership.index)
            except TransportError as error:
                log.warning("the coordinator does not hear the heartbeat: %s", error)

    def _end(self, reason: str) -> NoReturn:
        """End the process, which may be deep in a solve.

        Membership is left first, which keeps the run's folder and shared memory in order.
        """
        # Nobody may be left to read it.
        with suppress(OSError):
            os.write(2, f"error: {reason}\n".encode())
        try:
            self._membership.leave()
        finally:
            os._exit(1)
