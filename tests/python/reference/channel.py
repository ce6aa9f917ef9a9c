"""One way of the link: what was sent arrives after the case's delay. No jitter, no loss.

A packet is sent every second tick (500 Hz) and holds until the next one comes. What is sent in a
tick arrives in the next one at the soonest.
"""

import numpy as np

PERIOD = 2
"""From one packet to the next [ticks]."""


class Channel:
    """Packets of `rest.shape[0]` numbers; before the first one arrives, `rest` counts."""

    def __init__(self, delay: np.ndarray, rest: np.ndarray) -> None:
        self.delay = np.maximum(delay, 1)
        length = int(self.delay.max()) + 2 * PERIOD
        self.sent = np.repeat(rest[None], length, axis=0)
        self.rest = rest
        self.cases = np.arange(rest.shape[1])

    def arrived(self, tick: int) -> np.ndarray:
        """The newest packet."""
        when = (tick - self.delay) // PERIOD * PERIOD
        return np.where(when < 0, self.rest, self.sent[when % len(self.sent), :, self.cases].T)

    def send(self, tick: int, packet: np.ndarray) -> None:
        """A packet; what is sent between two periods is left out."""
        if tick % PERIOD == 0:
            self.sent[tick % len(self.sent)] = packet
