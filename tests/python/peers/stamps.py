"""What a subscriber saw of a stream: counts, rate, gaps."""

import time


class Stamps:
    """Arrivals of a stream, with the stamps in the messages' headers.

    `report` gives, for JSON: `received`; `rate_hz` between first and last
    arrival; `first_stamp_ns`, `last_stamp_ns` of the headers (None where there is no header); `stamp_rate_hz`
    between these; `max_gap_s` between two arrivals; `zero_stamps`, the number of
    messages with a stamp of zero; `stamps_back`, how often a stamp was older
    than the one before.
    """

    def __init__(self) -> None:
        self.received = 0
        self.first_arrival = 0.0
        self.last_arrival = 0.0
        self.max_gap = 0.0
        self.stamped = 0
        self.first_stamp: int | None = None
        self.last_stamp: int | None = None
        self.zero_stamps = 0
        self.stamps_back = 0

    def saw(self, message: object) -> None:
        """Counts one message."""
        now = time.monotonic()
        if self.received == 0:
            self.first_arrival = now
        else:
            self.max_gap = max(self.max_gap, now - self.last_arrival)
        self.last_arrival = now
        self.received += 1
        header = getattr(message, "header", None)
        if header is None:
            return
        stamp = header.stamp.sec * 1_000_000_000 + header.stamp.nanosec
        self.zero_stamps += stamp == 0
        if self.first_stamp is None:
            self.first_stamp = stamp
        if self.last_stamp is not None:
            self.stamps_back += stamp < self.last_stamp
        self.last_stamp = stamp
        self.stamped += 1

    def report(self) -> dict[str, object]:
        """The counts so far."""
        span = self.last_arrival - self.first_arrival
        stamp_span = (self.last_stamp or 0) - (self.first_stamp or 0)
        return {
            "received": self.received,
            "rate_hz": (self.received - 1) / span if span > 0 else 0.0,
            "stamp_rate_hz": (self.stamped - 1) * 1e9 / stamp_span if stamp_span > 0 else 0.0,
            "first_stamp_ns": self.first_stamp,
            "last_stamp_ns": self.last_stamp,
            "max_gap_s": self.max_gap,
            "zero_stamps": self.zero_stamps,
            "stamps_back": self.stamps_back,
        }
