"""The laws by the plain equations of their papers, for a tip that takes positions.

Force on the hand and contact force on the tip are negative where the surface pushes out. Each law
has two ends; `leader` takes the hand and what arrived and gives the force on the hand and what to
send, `follower` takes the tip, the contact's force on it and what arrived and gives where the tip
is to be and what to send. All arrays are (rows, cases). Scale one to one.

Where a paper has the tip driven by a force f, the servo is told to be f by its stiffness ahead of
the tip, and what its damper takes is made up for (`driven`): then the tip is the papers' mass.
"""

import numpy as np

from .bodies import SERVO_DAMPING, SERVO_STIFFNESS, TICK

Ends = tuple[np.ndarray, np.ndarray]


def driven(force: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """The command with which the servo pushes the tip with `force` [N]."""
    return position + (force + SERVO_DAMPING * velocity) / SERVO_STIFFNESS


def shortened(own: np.ndarray, most: float) -> np.ndarray:
    """No longer than `most`."""
    return own * np.minimum(1.0, most / np.maximum(np.hypot(*own), 1e-12))


def at_rest(start: np.ndarray, more: int) -> np.ndarray:
    """A packet before the first one: the place at the start, then `more` zeros."""
    return np.concatenate([start, np.zeros((more, start.shape[1]))])


class PositionForce:
    """x_d = x_h(t - T1), F = F_e(t - T2) (Lawrence 1993, section III)."""

    name = "position_force"

    def __init__(self, start: np.ndarray, environments: np.ndarray) -> None:
        self.forth, self.back = at_rest(start, 0), at_rest(start, 0) * 0.0

    def leader(self, x: np.ndarray, v: np.ndarray, got: np.ndarray) -> Ends:
        return got, x

    def follower(self, x: np.ndarray, v: np.ndarray, contact: np.ndarray, got: np.ndarray) -> Ends:
        return got, contact


class PositionPosition:
    """P + d (Nuño, Basañez, Ortega, Spong 2009): each end a spring to the other's delayed place
    and a damper, F = K (x_s(t - T2) - x_h) - B v_h and the same at the tip. Stable for
    4 B² >= (T1 + T2)² K²; here B = K τ/2 + b for a round trip τ."""

    name = "position_position"
    stiffness, extra, round_trip = 200.0, 5.0, 0.1

    def __init__(self, start: np.ndarray, environments: np.ndarray) -> None:
        self.forth = self.back = at_rest(start, 0)
        self.damping = 0.5 * self.stiffness * self.round_trip + self.extra

    def leader(self, x: np.ndarray, v: np.ndarray, got: np.ndarray) -> Ends:
        return self.stiffness * (got - x) - self.damping * v, x

    def follower(self, x: np.ndarray, v: np.ndarray, contact: np.ndarray, got: np.ndarray) -> Ends:
        return driven(self.stiffness * (got - x) - self.damping * v, x, v), x


class FourChannel:
    """Positions and forces both ways (Lawrence 1993, section IV, without the masses' feedforward):
    F = F_e(t - T2) + K (x_s(t - T2) - x_h) + B (v_s(t - T2) - v_h), and the tip is driven by
    f = F_h(t - T1) + K (x_h(t - T1) - x_s) + B (v_h(t - T1) - v_s), F_h what the hand gives: -F."""

    name = "four_channel"
    stiffness, damping = 200.0, 20.0

    def __init__(self, start: np.ndarray, environments: np.ndarray) -> None:
        self.forth = self.back = at_rest(start, 4)

    def coupled(self, x: np.ndarray, v: np.ndarray, got: np.ndarray) -> np.ndarray:
        return got[4:] + self.stiffness * (got[:2] - x) + self.damping * (got[2:4] - v)

    def leader(self, x: np.ndarray, v: np.ndarray, got: np.ndarray) -> Ends:
        force = self.coupled(x, v, got)
        return force, np.concatenate([x, v, -force])

    def follower(self, x: np.ndarray, v: np.ndarray, contact: np.ndarray, got: np.ndarray) -> Ends:
        return driven(self.coupled(x, v, got), x, v), np.concatenate([x, v, contact])


class FourChannelCommanded(FourChannel):
    """The same for a tip that takes positions and has no mass to be driven: what is commanded, x_c,
    gives way to the forces, B v_c = F_h(t - T1) + K (x_h(t - T1) - x_c) + B v_h(t - T1) - F_s, with F_s
    the force of the servo's spring while the tip touches. At rest 2 x_h = x_s + x_c: the hand feels
    twice the servo's stiffness in series with the surface."""

    name = "four_channel_commanded"

    def __init__(self, start: np.ndarray, environments: np.ndarray) -> None:
        super().__init__(start, environments)
        self.command = start.copy()

    def follower(self, x: np.ndarray, v: np.ndarray, contact: np.ndarray, got: np.ndarray) -> Ends:
        touches = (contact != 0.0).any(axis=0)
        pull = got[4:] + self.stiffness * (got[:2] - self.command) + self.damping * got[2:4]
        pull = pull - SERVO_STIFFNESS * (self.command - x) * touches
        # Implicit in both springs.
        give = self.damping + (self.stiffness + SERVO_STIFFNESS) * TICK
        self.command = self.command + pull / give * TICK
        return self.command, np.concatenate([x, v, contact])


class Wave:
    """Wave variables (Niemeyer and Slotine 1991): u = (b v_h + F)/√(2b) goes forth, and
    w = (b v_sd - F_s)/√(2b) comes back, F_s the force of the servo that takes the tip to
    x_sd = ∫ v_sd by its spring and damper. The follower's end is matched by a damper b. A packet
    has the mean of the wave since the last one: a wave that is sampled bare could gain energy."""

    name = "wave"
    impedance, damping = 10.0, 2.0

    drift_stiffness, drift_speed = 0.0, 0.05

    def __init__(self, start: np.ndarray, environments: np.ndarray) -> None:
        self.forth, self.back = at_rest(start, 2), at_rest(start, 0) * 0.0
        self.root = np.sqrt(2.0 * self.impedance)
        self.wanted = start.copy()
        self.last_u = self.last_w = np.zeros_like(start)

    def leader(self, x: np.ndarray, v: np.ndarray, got: np.ndarray) -> Ends:
        u = self.root * v - got
        mean, self.last_u = 0.5 * (u + self.last_u), u
        force = self.root * got - (self.impedance + self.damping) * v
        return force, np.concatenate([x, mean])

    def follower(self, x: np.ndarray, v: np.ndarray, contact: np.ndarray, got: np.ndarray) -> Ends:
        # √(2b) u = F_s + 2 b v_sd with F_s = k (x_sd - x_s) + d (v_sd - v_s).
        k, d = SERVO_STIFFNESS, SERVO_DAMPING
        pull = shortened(self.drift_stiffness * (got[:2] - self.wanted), 2.0 * self.impedance * self.drift_speed)
        given = self.root * got[2:] + pull - k * (self.wanted - x) + d * v
        speed = given / (2.0 * self.impedance + d + k * TICK)
        self.wanted = self.wanted + speed * TICK
        force = k * (self.wanted - x) + d * (speed - v)
        w = -force / self.root
        mean, self.last_w = 0.5 * (w + self.last_w), w
        # The servo damps the tip's own motion: what is wanted moves too.
        return self.wanted + d / k * speed, mean


class WaveDrift(Wave):
    """The same with the hand's place sent along, to which a spring pulls the tip (after Chopra,
    Spong, Ortega, Barabanov 2006), bounded in speed."""

    name = "wave_drift"
    drift_stiffness = 60.0


class Tdpa:
    """Time-domain passivity with energy in packets (Ryu, Artigas, Preusche 2010): velocity forth,
    force back, and at each port what left the two-port may not be more than what had entered at the
    other one when its newest packet was sent. The leader's controller takes from the force, the
    follower's from the velocity, just as much as is missing, within bounds: at a hand that stands, or
under no force, what is missing would ask for an endless force or speed. A damper at the hand
takes in what the first contact needs."""

    name = "tdpa"
    damping, most_damping, most_speed = 10.0, 200.0, 0.2
    drift_time, drift_speed = 0.05, 0.0

    def __init__(self, start: np.ndarray, environments: np.ndarray) -> None:
        self.forth, self.back = at_rest(start, 3), np.zeros((3, start.shape[1]))
        self.wanted = start.copy()
        # What entered and what left, leader and follower [J].
        self.entered = np.zeros((2, start.shape[1]))
        self.left = np.zeros((2, start.shape[1]))
        self.felt = np.zeros_like(start)
        self.last_x, self.contact = start.copy(), np.zeros_like(start)

    def missing(self, end: int, power: np.ndarray, promised: np.ndarray) -> np.ndarray:
        """Of the energy that would leave in this tick, what has not come in [J]."""
        out = np.maximum(power, 0.0) * TICK
        return np.where(power > 0.0, np.clip(self.left[end] + out - promised, 0.0, None), 0.0)

    def count(self, end: int, energy: np.ndarray) -> None:
        """What went through the port: positive where it left the two-port."""
        self.left[end] += np.maximum(energy, 0.0)
        self.entered[end] += np.maximum(-energy, 0.0)

    def leader(self, x: np.ndarray, v: np.ndarray, got: np.ndarray) -> Ends:
        way, self.last_x = x - self.last_x, x
        self.count(0, (self.felt * way).sum(axis=0))
        force = got[:2] - self.damping * v
        missing = self.missing(0, (force * v).sum(axis=0), got[2])
        square = np.maximum((v * v).sum(axis=0), 1e-12)
        force = force - np.minimum(missing / (TICK * square), self.most_damping) * v
        self.felt = force
        return force, np.concatenate([x, v, self.entered[:1]])

    def follower(self, x: np.ndarray, v: np.ndarray, contact: np.ndarray, got: np.ndarray) -> Ends:
        speed = got[2:4] + shortened((got[:2] - self.wanted) / self.drift_time, self.drift_speed)
        missing = self.missing(1, -(contact * speed).sum(axis=0), got[4])
        size = np.maximum(np.hypot(*contact), 1e-9)
        speed = speed + np.minimum(missing / (TICK * size), self.most_speed) * contact / size
        self.count(1, -(contact * speed).sum(axis=0) * TICK)
        self.wanted = self.wanted + speed * TICK
        return self.wanted, np.concatenate([contact, self.entered[1:]])


class TdpaDrift(Tdpa):
    """The same with the hand's place sent along: what the controller took off the way is made up
    for while there is energy for it (Artigas, Ryu, Preusche 2010)."""

    name = "tdpa_drift"
    drift_speed = 0.1


class ModelMediated:
    """The follower sends place and stiffness of what it touches, the leader renders it
    (Hannaford 1989; Mitra and Niemeyer 2008): F = K (x_w - x_h) behind x_w, less b v_h; the tip goes
    where the hand is. Here the stiffness is known beforehand, and so where the surface is while it
    is touched: x_s - F/K. No blending. K rendered is bounded, and so is the force."""

    name = "model_mediated"
    damping, stiffest, most, threshold = 14.0, 3300.0, 30.0, 0.1

    def __init__(self, start: np.ndarray, environments: np.ndarray) -> None:
        self.forth, self.back = at_rest(start, 0), np.zeros((2, start.shape[1]))
        self.known = np.maximum(environments, 1e-9)
        self.place, self.touched = np.zeros(start.shape[1]), np.zeros(start.shape[1])

    def leader(self, x: np.ndarray, v: np.ndarray, got: np.ndarray) -> Ends:
        place, known = got
        stiffness = np.minimum(self.known, self.stiffest)
        push = np.where(known > 0.0, stiffness * np.maximum(x[0] - place, 0.0), 0.0)
        force = -self.damping * v
        force[0] -= np.minimum(push, self.most)
        return force, x

    def follower(self, x: np.ndarray, v: np.ndarray, contact: np.ndarray, got: np.ndarray) -> Ends:
        touches = -contact[0] > self.threshold
        self.place = np.where(touches, x[0] + contact[0] / self.known, self.place)
        self.touched = np.maximum(self.touched, touches)
        return got, np.stack([self.place, self.touched])


EVERY = (
    PositionForce,
    PositionPosition,
    FourChannel,
    FourChannelCommanded,
    Wave,
    WaveDrift,
    Tdpa,
    TdpaDrift,
    ModelMediated,
)
LAWS = {own.name: own for own in EVERY}
