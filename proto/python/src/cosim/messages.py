"""Fixed layouts of everything that crosses shared memory.

They are those of `proto/contract/src/message.rs`, field by field; the tests pin every size and offset. Text
sits in zero-padded ASCII labels. JSON travels as bytes behind a `Command` or `Reply`, field values
as doubles behind a `FieldHeader`.
"""

from __future__ import annotations

import ctypes
import enum
from typing import ClassVar

#: Version of the contract, `PROTOCOL_VERSION` of the crate `proto`.
PROTOCOL_VERSION = 5

#: The most inputs one participant can have.
MAX_INPUTS = 16

#: Flag of `Accept`: publish the observed fields, and reply.
OBSERVE = 1

#: Flag of `Accept`: reply with the figures of the accepted state.
FIGURES = 2

#: Flag of `Finish`: stay for another run.
STAY = 1


class CommandKind(enum.IntEnum):
    """What a command asks for."""

    DESCRIBE = 1
    CONFIGURE = 2
    CONNECT = 3
    INITIALISE = 4
    SOLVE = 5
    ACCEPT = 6
    SAVE = 7
    RESTORE = 8
    FINISH = 9


class Beat(enum.IntEnum):
    """What a heartbeat says: the participant works, or waits after a command.

    Commands are distinguished by their number modulo four.
    """

    BUSY = 0
    IDLE_0 = 1
    IDLE_1 = 2
    IDLE_2 = 3
    IDLE_3 = 4

    @classmethod
    def idle_after(cls, command: int) -> Beat:
        """Idle after the command with this number."""
        return cls(1 + command % 4)


class Status(enum.IntEnum):
    """How a command ended."""

    DONE = 0
    FAILED = 1
    REFUSED = 2


class Command(ctypes.Structure):
    """From the coordinator to one participant."""

    _fields_: ClassVar = [
        ("protocol", ctypes.c_uint32),
        ("kind", ctypes.c_uint32),
        ("sequence", ctypes.c_uint64),
        ("window", ctypes.c_uint64),
        ("iteration", ctypes.c_uint32),
        ("flags", ctypes.c_uint32),
        ("start", ctypes.c_double),
        ("end", ctypes.c_double),
        ("expected", ctypes.c_uint64 * MAX_INPUTS),
    ]

    @staticmethod
    def type_name() -> str:
        """Name under which both sides know the layout."""
        return "cosim.Command.v1"


class Reply(ctypes.Structure):
    """From one participant to the coordinator."""

    _fields_: ClassVar = [
        ("protocol", ctypes.c_uint32),
        ("status", ctypes.c_uint32),
        ("sequence", ctypes.c_uint64),
        ("work", ctypes.c_uint64),
        ("substeps", ctypes.c_uint32),
        ("inner_iterations", ctypes.c_uint32),
        ("heat_received", ctypes.c_double),
        ("model_seconds", ctypes.c_double),
        ("wanted_window", ctypes.c_double),
    ]

    @staticmethod
    def type_name() -> str:
        """Name under which both sides know the layout."""
        return "cosim.Reply.v2"


class ProgressReport(ctypes.Structure):
    """How far a participant is with the command that it works on, for its heartbeat."""

    _fields_: ClassVar = [
        ("sequence", ctypes.c_uint64),
        ("done", ctypes.c_uint64),
        ("of", ctypes.c_uint64),
        ("what", ctypes.c_char * 32),
    ]

    @staticmethod
    def type_name() -> str:
        """Name under which both sides know the layout."""
        return "cosim.ProgressReport.v1"


class FieldHeader(ctypes.Structure):
    """Stands before the values of every field: a field never travels unlabelled."""

    _fields_: ClassVar = [
        ("protocol", ctypes.c_uint32),
        ("components", ctypes.c_uint32),
        ("points", ctypes.c_uint64),
        ("grid_revision", ctypes.c_uint64),
        ("window", ctypes.c_uint64),
        ("iteration", ctypes.c_uint32),
        ("reserved", ctypes.c_uint32),
        ("start", ctypes.c_double),
        ("end", ctypes.c_double),
        ("sequence", ctypes.c_uint64),
        ("name", ctypes.c_char * 32),
        ("unit", ctypes.c_char * 16),
        ("producer", ctypes.c_char * 32),
        ("grid", ctypes.c_char * 32),
    ]

    @staticmethod
    def type_name() -> str:
        """Name under which both sides know the layout."""
        return "cosim.FieldHeader.v1"


def text_of(label: bytes) -> str:
    """The text of a label; bytes that are not UTF-8 read as empty."""
    try:
        return label.decode()
    except UnicodeDecodeError:
        return ""
