"""What Haply's Inverse Service does, without a device: frames of an Inverse3 and a grip over a WebSocket.

Writes "ready" to stderr. To whoever is connected it sends a frame every millisecond, whose cursor rests until SIGUSR1
comes, goes by `--way` (x, y, z of the device [m]) within 2 s, and stays, while the grip turns slowly; after 1.5 s it
falls silent there, but listens for another second. Who connects again finds the hand where it has come to. Prints JSON:
`frames` sent, `answers` received, `first_N` (size of the strongest force in the first 0.1 s of the first connection),
`peak` (the strongest force, x, y, z [N]), `before_N` (size of the last force before it fell silent), `last_N` (of the
last at all), `bad` (answers that Haply's service would not take).
"""

import argparse
import asyncio
import json
import signal
import sys

import numpy as np
import websockets

# Where a device's cursor rests [m].
MIDDLE = np.array([0.02, -0.13, 0.18])
DEVICE = "04C3"


def force_of(text: str) -> np.ndarray | None:
    try:
        (own,) = json.loads(text)["inverse3"]
        assert own["device_id"] == DEVICE
        values = own["commands"]["set_cursor_force"]["values"]
        force = np.array([values[axis] for axis in "xyz"], dtype=float)
        assert np.isfinite(force).all()
        return force
    except (KeyError, TypeError, ValueError, AssertionError):
        return None


def reach(share: float) -> float:
    s = min(max(share, 0.0), 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s * s)


async def main() -> None:
    parser = argparse.ArgumentParser(description="Haply's Inverse Service without a device.")
    parser.add_argument("--port", type=int, required=True)
    parser.add_argument("--way", type=float, nargs=3, default=[0.0, 0.033, 0.0])
    options = parser.parse_args()
    told = {"frames": 0, "answers": 0, "first_N": 0.0, "peak": [0.0] * 3, "before_N": None, "last_N": None, "bad": 0}
    done = asyncio.Event()
    loop = asyncio.get_running_loop()
    # When the hand was told to go, and when somebody came first.
    went_at = float("inf")
    came_at = None

    def go() -> None:
        nonlocal went_at
        went_at = loop.time()

    loop.add_signal_handler(signal.SIGUSR1, go)

    def frame(first: bool) -> str:
        time = loop.time() - came_at
        went = reach((loop.time() - went_at) / 2.0)
        cursor = MIDDLE + went * np.array(options.way)
        axes = dict(zip("xyz", cursor.tolist()))
        half = 0.1 * np.sin(0.5 * time)
        state = {"cursor_position": axes, "cursor_velocity": dict.fromkeys("xyz", 0.0)}
        own = {"device_id": DEVICE, "state": state, "status": {"calibrated": True}}
        if first:
            own["config"] = {"handedness": "right"}
        turn = {"w": float(np.cos(half)), "x": 0.0, "y": 0.0, "z": float(np.sin(half))}
        grip = {"device_id": "61576", "state": {"orientation": turn, "buttons": {"a": False}}}
        return json.dumps({"inverse3": [own], "wireless_verse_grip": [grip]})

    async def serve(socket) -> None:
        nonlocal came_at
        begin = loop.time()
        is_first = came_at is None
        came_at = came_at or begin

        async def listen() -> None:
            async for text in socket:
                force = force_of(text)
                if force is None:
                    told["bad"] += 1
                    continue
                told["answers"] += 1
                size = float(np.linalg.norm(force))
                if is_first and loop.time() - begin < 0.1:
                    told["first_N"] = max(told["first_N"], size)
                if size > np.linalg.norm(told["peak"]):
                    told["peak"] = force.tolist()
                told["last_N"] = size

        listening = asyncio.create_task(listen())
        sent = 0
        while loop.time() - went_at < 3.5:
            await socket.send(frame(sent == 0))
            sent += 1
            told["frames"] += 1
            await asyncio.sleep(max(0.0, begin + sent * 1e-3 - loop.time()))
        # Who comes again after the silence is told no more.
        if told["before_N"] is None:
            told["before_N"] = told["last_N"]
            await asyncio.sleep(1.0)
            done.set()
        await done.wait()
        listening.cancel()

    async with websockets.serve(serve, "127.0.0.1", options.port):
        print("ready", file=sys.stderr, flush=True)
        await done.wait()
    print(json.dumps(told))


if __name__ == "__main__":
    asyncio.run(main())
