"""The delay laws by the plain equations of their papers, on the cases of `ferntast sweep`.

Reads JSON from stdin: `rtt_ms`, `environments`, `tasks` and `laws`, a list of {kind, and parameters
of the law as in `reference/laws.py`}. What a case is made of (hand, light tip, surfaces, tasks) and
how it is judged is that of a sweep without the line `arm`; nothing is shared with its code. Prints
JSON: a row a case, named as in the rows of a sweep, all chance left out. With `--beside FILE`, the
`sweep.json` of a sweep, prints the rows of both beside each other in Markdown instead.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from reference.bodies import TICK, Hand, Tip
from reference.channel import Channel
from reference.judge import START, Case, Record, judged
from reference.laws import LAWS
from reference.table import beside


class Run:
    """All cases of one task, law by law in slices, side by side in time."""

    def __init__(self, laws: list[tuple[type, dict]], cases: list[list[Case]]) -> None:
        every = [case for own in cases for case in own]
        start = np.zeros((2, len(every)))
        start[0] = START
        self.every = every
        self.hand = Hand(start)
        self.tip = Tip(start, [case.environment for case in every])
        self.felt, self.command = np.zeros_like(start), start.copy()
        self.hand_work = np.zeros(len(every))
        self.wall = np.array([case.wall for case in every])
        self.retreat = np.array([case.retreat if case.task == "let_go" else np.inf for case in every])
        self.ends = []
        first = 0
        for (law, parameters), own in zip(laws, cases, strict=True):
            part = slice(first, first + len(own))
            first += len(own)
            kind = type(law.__name__, (law,), parameters)
            end = kind(start[:, part], self.tip.stiffness[part])
            delay = np.array([case.one_way for case in own])
            ways = Channel(delay, end.forth), Channel(delay, end.back)
            self.ends.append((part, end, *ways))

    def step(self, tick: int, wanted: np.ndarray, rate: np.ndarray) -> None:
        """Hand and tip move for a tick, then both ends of each law."""
        time = tick * TICK
        before = self.hand.position
        self.hand.step(wanted, rate, time >= self.retreat, self.felt)
        self.hand_work -= (self.felt * (self.hand.position - before)).sum(axis=0)
        self.tip.step(self.command, time - self.wall)
        x, v = self.hand.position, self.hand.velocity
        force, command = np.empty_like(x), np.empty_like(x)
        for part, end, forth, back in self.ends:
            force[:, part], sent = end.leader(x[:, part], v[:, part], back.arrived(tick))
            tip, contact = self.tip.position[:, part], self.tip.force[:, part]
            got = forth.arrived(tick)
            command[:, part], answer = end.follower(tip, self.tip.velocity[:, part], contact, got)
            forth.send(tick, sent)
            back.send(tick, answer)
        self.felt, self.command = force, command

    def rows(self) -> list[dict]:
        """Runs to the end of the longest case, then judges each over its own time."""
        ticks = [round(case.end / TICK) for case in self.every]
        longest, count = max(ticks), len(self.every)
        time = TICK * np.arange(longest)
        wanted, rate = np.empty((2, longest, 2, count))
        for index, case in enumerate(self.every):
            wanted[:, :, index], rate[:, :, index] = case.wanted(time)
        kept = np.empty((longest, 12, count))
        for tick in range(longest):
            self.step(tick, wanted[tick], rate[tick])
            hand, tip = self.hand, self.tip
            place, _ = tip.surface(time[tick] - self.wall)
            energy = self.hand_work + tip.work
            kept[tick, 0:2], kept[tick, 2:4] = hand.position, hand.velocity
            kept[tick, 4:6], kept[tick, 6:8] = tip.position, self.felt
            kept[tick, 8:10], kept[tick, 10], kept[tick, 11] = tip.force, place, energy
        rows = []
        for index, (case, end) in enumerate(zip(self.every, ticks, strict=True)):
            own = kept[:end, :, index]
            pairs = [own[:, first : first + 2] for first in (0, 2, 4, 6, 8)]
            rows.append(judged(case, Record(*pairs, own[:, 10], own[:, 11])))
        return rows


def swept(given: dict) -> list[dict]:
    """Every row."""
    laws = []
    for law in given["laws"]:
        parameters = {key: value for key, value in law.items() if key != "kind"}
        laws.append((LAWS[law["kind"]], parameters))
    rows = []
    for task in given["tasks"]:
        places = [(where, trip) for where in given["environments"] for trip in given["rtt_ms"]]
        cases = [[Case(law.name, where, task, trip) for where, trip in places] for law, _ in laws]
        rows += Run(laws, cases).rows()
    return rows


def main() -> None:
    """Reads, runs, prints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--beside", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    rows = swept(json.load(sys.stdin))
    if arguments.beside:
        print(beside(json.loads(arguments.beside.read_text()), rows))
    else:
        json.dump(rows, sys.stdout)


if __name__ == "__main__":
    main()
