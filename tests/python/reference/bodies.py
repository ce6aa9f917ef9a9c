"""Hand, tip and surface of the cases: many cases at once, vectors as arrays of shape (2, cases).

x goes into the surface, y along it; the surface is at x = 0 and free before it. The hand is a mass
that a spring and a damper pull to where the operator wants it; the tip a mass behind the spring and
damper of its servo. Both are integrated here by means of their own: the hand exactly for a force
that is held for a tick, the tip by semi-implicit Euler steps of 0.1 ms.
"""

import numpy as np

TICK = 1e-3
"""Of the control [s]."""
PARTS = 10
"""Steps of the tip in a tick."""

HAND = (0.5, 20.0, 300.0)
"""Mass [kg], damping [N s/m], stiffness [N/m] of the hand that holds,"""
LET_GO = (0.2, 1.0, 1.0)
"""and of a handle in nobody's hand."""

TIP_MASS = 0.3
SERVO_STIFFNESS = TIP_MASS * 150.0**2
SERVO_DAMPING = 2 * TIP_MASS * 150.0
SERVO_REACH = 0.01
"""The servo's spring is stretched no further [m]."""
WORKSPACE = 0.5
"""The tip is sent no further from the origin [m]."""
BRISTLE = 3000.0
"""Stiffness of sticking friction [N/m]."""

ENVIRONMENTS = {
    # stiffness [N/m], damping [N s/m], friction [-], moves
    "free": (0.0, 0.0, 0.0, False),
    "soft_spring": (100.0, 0.0, 0.0, False),
    "hard_wall": (20_000.0, 50.0, 0.0, False),
    "wall_with_friction": (20_000.0, 50.0, 0.3, False),
    "moving_wall": (2000.0, 10.0, 0.0, True),
    "corner": (20_000.0, 50.0, 0.0, False),
}
CORNERS = {"corner"}
"""Where there is a block on the wall, as stiff:"""
SIDE = 0.005
"""the place of its side, across y [m],"""
SIDE_LENGTH = 0.01
"""and how far its front is before the wall [m]."""


def discretised(mass: float, damping: float, stiffness: float) -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity after a tick by those before and by a held force, exactly."""
    system = np.zeros((3, 3))
    system[0, 1] = TICK
    system[1] = np.array([-stiffness, -damping, 1.0]) * TICK / mass
    whole, term = np.eye(3), np.eye(3)
    for order in range(1, 12):
        term = term @ system / order
        whole = whole + term
    return whole[:2, :2], whole[:2, 2]


class Hand:
    """What the operator holds, at rest at `start` [m]."""

    def __init__(self, start: np.ndarray) -> None:
        self.position = start.copy()
        self.velocity = np.zeros_like(start)
        self.held, self.free = discretised(*HAND), discretised(*LET_GO)

    def step(self, wanted: np.ndarray, rate: np.ndarray, let_go: np.ndarray, force: np.ndarray) -> None:
        """One tick to where the operator wants it [m], at a rate [m/s], under a force [N]."""
        state = np.stack([self.position, self.velocity])
        after = np.zeros_like(state)
        for (own, by_force), (_, damping, stiffness), mask in (
            (self.held, HAND, ~let_go),
            (self.free, LET_GO, let_go),
        ):
            pull = stiffness * wanted + damping * rate + force
            after += mask * (np.einsum("ij,jkn->ikn", own, state) + by_force[:, None, None] * pull)
        self.position, self.velocity = after


class Tip:
    """The tip behind its servo, at rest at `start` [m], before the surfaces of the cases."""

    def __init__(self, start: np.ndarray, environments: list[str]) -> None:
        stiffness, damping, friction, moves = zip(*(ENVIRONMENTS[own] for own in environments), strict=True)
        self.stiffness, self.damping = np.array(stiffness), np.array(damping)
        self.friction, self.moves = np.array(friction), np.array(moves)
        self.corner = np.array([own in CORNERS for own in environments])
        self.at_side = np.zeros(len(environments), dtype=bool)
        self.at_front = self.at_side.copy()
        self.position = start.copy()
        self.velocity = np.zeros_like(start)
        self.bend = np.zeros(len(environments))
        self.force = np.zeros_like(start)
        self.work = np.zeros(len(environments))

    def surface(self, since: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Place [m] and speed [m/s] of the surface so long after it began to move [s]."""
        moving = self.moves & (since >= 0.0) & (since < 4.0)
        rate = np.pi
        place = np.where(moving, -0.005 * (1.0 - np.cos(rate * since)), 0.0)
        return place, np.where(moving, -0.005 * rate * np.sin(rate * since), 0.0)

    def step(self, command: np.ndarray, since: np.ndarray) -> None:
        """One tick towards `command` [m]; the surface began to move `since` [s] ago."""
        command = np.clip(command, -WORKSPACE, WORKSPACE)
        place, speed = self.surface(since)
        dt = TICK / PARTS
        for _ in range(PARTS):
            # The servo's own damper implicitly, all else as it is.
            pull = SERVO_STIFFNESS * np.clip(command - self.position, -SERVO_REACH, SERVO_REACH)
            pull += self.force
            self.velocity = (TIP_MASS * self.velocity + dt * pull) / (TIP_MASS + dt * SERVO_DAMPING)
            way = dt * self.velocity
            self.position = self.position + way
            self.work += (self.force * way).sum(axis=0)
            place = place + dt * speed
            self.contact(place, speed, way)

    def contact(self, place: np.ndarray, speed: np.ndarray, way: np.ndarray) -> None:
        """The surface's force on the tip: spring and damper that never pull, sticking friction."""
        depth = self.position[0] - place
        push = self.stiffness * depth + self.damping * (self.velocity[0] - speed)
        push = np.where(depth > 0.0, np.maximum(push, 0.0), 0.0)
        most = self.friction * push / BRISTLE
        self.bend = np.clip(self.bend + way[1], -most, most)
        self.force = np.stack([-push, -BRISTLE * self.bend]) - self.block(way)

    def block(self, way: np.ndarray) -> np.ndarray:
        """What the block pushes back with along both axes: its front and its side."""
        depth = np.stack([self.position[0] + SIDE_LENGTH, self.position[1] - SIDE])
        inside = self.corner & (depth > 0.0).all(axis=0)
        # Who comes round the end of a face is behind that one.
        self.at_front = inside & (self.at_front | (depth[0] <= way[0]))
        self.at_side = inside & (self.at_side | (depth[1] <= way[1]))
        push = np.maximum(self.stiffness * depth + self.damping * self.velocity, 0.0)
        return np.where(np.stack([self.at_front, self.at_side]), push, 0.0)
