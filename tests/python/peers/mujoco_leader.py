"""A leader arm in MuJoCo whose tip a hand holds: `--driver-leader 'process:python tests/python/peers/mujoco_leader.py'`.

The plant is that of `mujoco_plant.py`, with its options, and has nothing to touch. The hand is a spring and a damper
between the tip and where it wants that: at home first, from `BEGIN` on down by `--down` [m] within `WAY`, there for `STAY`,
up again, and so on. It holds the tip's orientation loosely. With `--truth FILE` each line has t_s, the hand's force on the
tip [N] and the tip [m] in x, y, z of the arm's base, as MuJoCo has them.
"""

import math

import mujoco
import mujoco_plant
import numpy as np

# Times of the hand's motion [s].
BEGIN, WAY, STAY, AWAY = 1.0, 1.5, 2.5, 1.0
# The hand: along [N/m], [N s/m], and about its axes [Nm/rad], [Nm s/rad].
STIFFNESS, DAMPING = 1000.0, 40.0
TURNING = (2.0, 0.2)


def share(time: float) -> tuple[float, float]:
    """How much of its way the hand has gone, and how fast that changes [1/s]."""
    moment = (time - BEGIN) % (2 * WAY + STAY + AWAY) if time > BEGIN else 0.0
    if moment >= WAY + STAY:
        done, rate = share_of_way((moment - WAY - STAY) / WAY)
        return 1.0 - done, -rate
    return share_of_way(moment / WAY)


def share_of_way(part: float) -> tuple[float, float]:
    part = min(1.0, part)
    turn = math.pi * part
    return 0.5 * (1 - math.cos(turn)), (0.5 * math.pi / WAY * math.sin(turn) if part < 1.0 else 0.0)


class Hand:
    """Pulls the tip as a wall would push it, and turns it as a push would."""

    def __init__(self, plant: mujoco_plant.Plant, down: float) -> None:
        self.plant = plant
        self.home = plant.place()
        self.turned = self.rotation()
        self.down = np.array([0.0, 0.0, -down])

    def rotation(self) -> np.ndarray:
        return self.plant.base.T @ self.plant.data.xmat[self.plant.tip].reshape(3, 3)

    def force(self, tip: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        gone, rate = share(self.plant.data.time)
        return STIFFNESS * (self.home + gone * self.down - tip) + DAMPING * (rate * self.down - velocity)

    def at(self, _time: float) -> tuple[np.ndarray, np.ndarray]:
        quaternion, away = np.empty(4), np.empty(3)
        mujoco.mju_mat2Quat(quaternion, (self.turned @ self.rotation().T).flatten())
        mujoco.mju_quat2Vel(away, quaternion, 1.0)
        turning = self.plant.base.T @ self.plant.turning @ self.plant.data.qvel
        return np.zeros(3), TURNING[0] * away - TURNING[1] * turning


class HeldPlant(mujoco_plant.Plant):
    def __init__(self, arm: dict, joints: list[str], options) -> None:
        super().__init__({**arm, "surface": []}, joints, options)
        hand = Hand(self, options.down)
        self.walls, self.pushes = [hand], [hand]


if __name__ == "__main__":
    mujoco_plant.main(HeldPlant)
