"""A link between two network namespaces with a delay and a rate, as netem makes one, for kernels without it.

relay_link.py NAMESPACE NAMESPACE DELAY_MS RATE_MBIT: makes an interface `v0` in each, and passes packets from one
to the other until it is ended; a packet that finds a thousand before it is dropped.
"""

import collections
import ctypes
import fcntl
import os
import select
import struct
import sys
import time

NEW_NETWORK = 0x40000000
SET_INTERFACE = 0x400454CA
TUN, PLAIN = 0x0001, 0x1000
MOST = 1000
LARGEST = 65536


def enter(path):
    """Moves this thread into a network namespace."""
    with open(path, "rb") as namespace:
        if ctypes.CDLL(None, use_errno=True).setns(namespace.fileno(), NEW_NETWORK) != 0:
            raise OSError(ctypes.get_errno(), f"cannot enter {path}")


def interface(namespace):
    """The end of a new interface `v0` that carries packets in and out of the namespace."""
    enter(f"/run/netns/{namespace}")
    end = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(end, SET_INTERFACE, struct.pack("16sH22x", b"v0", TUN | PLAIN))
    return end


def main():
    """Passes packets on."""
    first, second, delay_ms, rate_mbit = sys.argv[1:]
    delay, rate = 1e-3 * float(delay_ms), 1e6 * float(rate_mbit)
    ends = [interface(first), interface(second)]
    print("ready", flush=True)
    waiting = {end: collections.deque() for end in ends}
    free = dict.fromkeys(ends, 0.0)
    while True:
        now = time.monotonic()
        dues = [queue[0][0] for queue in waiting.values() if queue]
        timeout = max(0.0, min(dues) - now) if dues else None
        readable, _, _ = select.select(ends, [], [], timeout)
        now = time.monotonic()
        for source in readable:
            target = ends[1 - ends.index(source)]
            for _ in range(64):
                try:
                    packet = os.read(source, LARGEST)
                except (BlockingIOError, OSError):
                    break
                if len(waiting[target]) < MOST:
                    free[target] = max(now, free[target]) + 8 * len(packet) / rate
                    waiting[target].append((free[target] + delay, packet))
        for target, queue in waiting.items():
            while queue and queue[0][0] <= now:
                packet = queue.popleft()[1]
                try:
                    os.write(target, packet)
                except OSError:
                    pass  # The interface is down.


main()
