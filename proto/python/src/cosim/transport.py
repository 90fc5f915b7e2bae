"""Shared-memory services of a run: the only module that knows iceoryx2.

Services and their settings are those of `proto/src/transport.rs`; a difference is refused when a
service is opened. Nothing is lost silently: a send that does not reach everybody is an error. The
queues are longer than anything the protocol has in flight, so that a full one is a broken contract
and is not waited for.

Memory. A received sample is mapped read-only, and is given back to its producer when its Python
object dies. An array over it therefore holds on to the sample (see `views.py`); an array over a
loan holds on to the publisher whose segment it lies in.
"""

from __future__ import annotations

import ctypes
import os
import time
from collections.abc import Callable
from typing import Any, Generic, TypeVar

import iceoryx2 as iox

from .messages import PROTOCOL_VERSION, Beat, Command, FieldHeader, ProgressReport, Reply
from .run_dir import RunInfo

#: How long a waiting process polls before it sleeps [s].
POLL = 100e-6
#: Longest sleep before a poller is asked again whatever rings.
NAP = iox.Duration.from_millis(20)
#: Samples a subscriber's queue holds.
QUEUE = 4
#: Samples a subscriber may hold: the one in use and the one that replaces it.
BORROWED = 2
#: Largest number of participants, and of subscribers to one topic.
MAX_MEMBERS = 16
#: Samples in a field's segment: one being written, and two that readers may hold.
FIELD_SLOTS = 4
#: Event id of a message; the heartbeats of participant `i` ring with `len(Beat)` ids of its own.
MESSAGE = 0

T = TypeVar("T")
Header = TypeVar("Header", bound=ctypes.Structure)


class TransportError(Exception):
    """A failure of the shared-memory services."""


def _opening(service: str, cause: Exception) -> TransportError:
    return TransportError(f"cannot open the shared-memory service `{service}`: {_told(cause)}")


def _exchange(service: str, cause: Exception) -> TransportError:
    return TransportError(f"exchange on `{service}` failed: {_told(cause)}")


def _told(cause: Exception) -> str:
    return str(cause) or type(cause).__name__


class Endpoint:
    """A process's membership in the services of a run, under the run's own root and prefix."""

    def __init__(self, run: RunInfo) -> None:
        iox.set_log_level(iox.LogLevel.Fatal)
        config = iox.config.default()
        everywhere = config.global_cfg
        try:
            everywhere.prefix = iox.FileName.new(run.prefix)
            everywhere.root_path = iox.Path.new(str(run.folder))
            # A run's folder is removed as a whole, so nobody has to look for dead nodes.
            everywhere.service.cleanup_dead_nodes_on_open = False
            everywhere.node.cleanup_dead_nodes_on_creation = False
            everywhere.node.cleanup_dead_nodes_on_destruction = False
            builder = iox.NodeBuilder.new().config(config)
            builder = builder.signal_handling_mode(iox.SignalHandlingMode.Disabled)
            self.node = builder.create(iox.ServiceType.Ipc)
        except Exception as error:
            raise _opening(run.prefix, error) from error

    def _topic(
        self, name: str, element: type, header: type[ctypes.Structure], *, newest: bool = False
    ) -> Any:
        """With `newest` a sample replaces one that was not read."""
        version = iox.AttributeVerifier.new().require(
            iox.AttributeKey.new("cosim.protocol"), iox.AttributeValue.new(str(PROTOCOL_VERSION))
        )
        slice_of: Any = iox.Slice[element]
        builder = self.node.service_builder(iox.ServiceName.new(name))
        return (
            builder.publish_subscribe(slice_of)
            .user_header(header)
            .payload_alignment(iox.Alignment.new(64))
            .enable_safe_overflow(newest)
            .history_size(0)
            .subscriber_max_buffer_size(1 if newest else QUEUE)
            .subscriber_max_borrowed_samples(BORROWED)
            .max_publishers(1)
            .max_subscribers(MAX_MEMBERS)
            .max_nodes(MAX_MEMBERS + 1)
            .open_or_create_with_attributes(version)
        )

    def command_receiver(self, role: str) -> Receiver[Command]:
        """The way to receive commands."""
        name = f"command/{role}"
        try:
            topic = self._topic(name, ctypes.c_uint8, Command)
            return Receiver(topic.subscriber_builder().create(), name, Command)
        except Exception as error:
            raise _opening(name, error) from error

    def reply_sender(self, role: str) -> ReplySender:
        """The way to send replies."""
        name = f"reply/{role}"
        try:
            topic = self._topic(name, ctypes.c_uint8, Reply)
            builder = topic.publisher_builder().initial_max_slice_len(4096)
            builder = builder.allocation_strategy(iox.AllocationStrategy.PowerOfTwo)
            builder = builder.backpressure_strategy(iox.BackpressureStrategy.DiscardData)
            return ReplySender(builder.create(), name)
        except Exception as error:
            raise _opening(name, error) from error

    def field_writer(self, service: str, values: int, subscribers: int) -> FieldWriter:
        """A writer of a field's topic with room for samples of `values` doubles."""
        try:
            topic = self._topic(service, ctypes.c_double, FieldHeader)
            builder = topic.publisher_builder().initial_max_slice_len(max(values, 1))
            builder = builder.allocation_strategy(iox.AllocationStrategy.PowerOfTwo)
            builder = builder.max_loaned_samples(1).override_sample_preallocation(FIELD_SLOTS)
            builder = builder.backpressure_strategy(iox.BackpressureStrategy.DiscardData)
            return FieldWriter(builder.create(), topic, service, subscribers)
        except Exception as error:
            raise _opening(service, error) from error

    def field_reader(self, service: str) -> Receiver[FieldHeader]:
        """A reader of a field's topic."""
        try:
            topic = self._topic(service, ctypes.c_double, FieldHeader)
            return Receiver(topic.subscriber_builder().create(), service, FieldHeader)
        except Exception as error:
            raise _opening(service, error) from error

    def progress_sender(self, role: str) -> ProgressSender:
        """The way to say how far this participant is."""
        name = f"progress/{role}"
        try:
            topic = self._topic(name, ctypes.c_uint8, ProgressReport, newest=True)
            return ProgressSender(topic.publisher_builder().create(), name)
        except Exception as error:
            raise _opening(name, error) from error

    def _bell(self, name: str) -> Any:
        builder = self.node.service_builder(iox.ServiceName.new(name)).event()
        return (
            builder.max_listeners(1)
            .max_notifiers(2 * MAX_MEMBERS)
            .max_nodes(2 * MAX_MEMBERS + 1)
            .event_id_max_value(len(Beat) * MAX_MEMBERS)
            .disable_deadline()
            .disable_notifier_created_event()
            .disable_notifier_dropped_event()
            .disable_notifier_dead_event()
            .open_or_create()
        )

    def doorbell(self, role: str) -> Doorbell:
        """The doorbell of this process."""
        name = f"bell/{role}"
        try:
            return Doorbell(self._bell(name).listener_builder().create(), name)
        except Exception as error:
            raise _opening(name, error) from error

    def ringer(self, role: str) -> Ringer:
        """The means to ring another process's doorbell."""
        name = f"bell/{role}"
        try:
            return Ringer(self._bell(name).notifier_builder().create(), name)
        except Exception as error:
            raise _opening(name, error) from error


class Received(Generic[Header]):
    """A received sample: its header, and where its payload lies."""

    __slots__ = ("header", "length", "pointer", "sample")

    def __init__(self, sample: Any, header: Header) -> None:
        self.sample, self.header = sample, header
        self.pointer: int = sample.payload_ptr
        # `payload().len()` counts bytes in this version.
        self.length: int = sample.header.number_of_elements

    def body(self) -> bytes:
        """A copy of a payload of bytes."""
        return ctypes.string_at(self.pointer, self.length)


class Receiver(Generic[Header]):
    """Receives samples in the order they were sent."""

    def __init__(self, subscriber: Any, name: str, header: type[Header]) -> None:
        self._subscriber, self._name, self._header = subscriber, name, header

    def receive(self) -> Received[Header] | None:
        """The next sample, if one has come."""
        try:
            sample = self._subscriber.receive()
        except Exception as error:
            raise _exchange(self._name, error) from error
        if sample is None:
            return None
        kind: Any = self._header
        return Received(sample, kind.from_buffer_copy(_bytes_at(sample.user_header_ptr, kind)))


def _bytes_at(pointer: int, kind: type[ctypes.Structure]) -> bytes:
    return ctypes.string_at(pointer, ctypes.sizeof(kind))


class ReplySender:
    """Sends replies to the coordinator."""

    def __init__(self, publisher: Any, name: str) -> None:
        self._publisher, self._name = publisher, name

    def send(self, header: Reply, body: bytes) -> None:
        """Send one reply; it has reached the coordinator's queue when this returns."""
        try:
            sample = self._publisher.loan_slice_uninit(len(body))
            ctypes.memmove(sample.user_header_ptr, ctypes.byref(header), ctypes.sizeof(header))
            ctypes.memmove(sample.payload_ptr, body, len(body))
            reached = sample.assume_init().send()
        except Exception as error:
            raise _exchange(self._name, error) from error
        _all_reached(self._name, reached, 1)


class ProgressSender:
    """Says how far a participant is."""

    def __init__(self, publisher: Any, name: str) -> None:
        self._publisher, self._name = publisher, name

    def offer(self, report: ProgressReport) -> bool:
        """Send a report; whether it has reached the coordinator."""
        try:
            sample = self._publisher.loan_slice_uninit(0)
            ctypes.memmove(sample.user_header_ptr, ctypes.byref(report), ctypes.sizeof(report))
            reached: int = sample.assume_init().send()
        except Exception as error:
            raise _exchange(self._name, error) from error
        return reached > 0


def _all_reached(name: str, reached: int, expected: int) -> None:
    if reached != expected:
        raise TransportError(f"a sample of `{name}` reached {reached} of {expected} receivers")


class FieldLoan:
    """A place in shared memory to write a field's values into."""

    __slots__ = ("pointer", "publisher", "sample")

    def __init__(self, sample: Any, publisher: Any) -> None:
        self.sample, self.publisher = sample, publisher
        self.pointer: int = sample.payload_ptr


class FieldWriter:
    """Publishes one field."""

    def __init__(self, publisher: Any, topic: Any, name: str, subscribers: int) -> None:
        self._publisher, self._topic, self._name = publisher, topic, name
        self._subscribers = subscribers

    def wait_for_subscribers(self, deadline: float) -> None:
        """Wait until all that have to receive the field are there; `deadline` is monotonic."""
        start = time.monotonic()
        while self._topic.dynamic_config.number_of_subscribers < self._subscribers:
            if time.monotonic() >= deadline:
                seconds = time.monotonic() - start
                raise TransportError(f"nobody joined `{self._name}` within {seconds:.0f} s")
            time.sleep(200e-6)

    def loan(self, values: int) -> FieldLoan:
        """A place for `values` doubles; it holds old data until written."""
        try:
            return FieldLoan(self._publisher.loan_slice_uninit(values), self._publisher)
        except Exception as error:
            raise _exchange(self._name, error) from error

    def publish(self, loan: FieldLoan, header: FieldHeader) -> None:
        """Publish a written loan."""
        try:
            ctypes.memmove(loan.sample.user_header_ptr, ctypes.byref(header), ctypes.sizeof(header))
            reached = loan.sample.assume_init().send()
        except Exception as error:
            raise _exchange(self._name, error) from error
        _all_reached(self._name, reached, self._subscribers)


class Doorbell:
    """Where a process sleeps until something comes for it.

    A waiting process first polls and yields the processor between polls, for at most `POLL`, and
    only then sleeps: waking a process takes tens of microseconds, most of a small exchange.
    """

    def __init__(self, listener: Any, name: str) -> None:
        self._listener, self._name = listener, name

    def wait(self, poll: Callable[[], T | None]) -> T:
        """Poll until there is a value, at least every `NAP`."""
        start = time.monotonic()
        while True:
            value = poll()
            if value is not None:
                return value
            if time.monotonic() - start < POLL:
                os.sched_yield()
                continue
            try:
                self._listener.timed_wait(NAP)
            except Exception as error:
                # A signal that the process handles ends the nap, and is no failure.
                if "Interrupt" not in _told(error):
                    raise _exchange(self._name, error) from error


class Ringer:
    """Rings another process's doorbell; may be shared between threads."""

    def __init__(self, notifier: Any, name: str) -> None:
        self._notifier, self._name = notifier, name
        self._message = iox.EventId.new(MESSAGE)

    def ring(self) -> None:
        """A message has been sent."""
        self._notify(self._message)

    def beat(self, index: int, beat: Beat) -> None:
        """The heart of participant `index` has beaten."""
        self._notify(iox.EventId.new(MESSAGE + 1 + len(Beat) * index + beat))

    def _notify(self, event: Any) -> None:
        try:
            self._notifier.notify_with_custom_event_id(event)
        except Exception as error:
            raise _exchange(self._name, error) from error
