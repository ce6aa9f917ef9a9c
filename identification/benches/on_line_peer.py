"""The same rows through padasip's RLS and NumPy's least squares on a sliding window."""

import sys
import time

import numpy as np
import padasip

file, memory, index, before, after, period = sys.argv[1:]
memory, index, period = int(float(memory)), int(index), float(period)
before, after = float(before), float(after)
rows = np.loadtxt(file, delimiter=",")
phi, y = rows[:, :-1], rows[:, -1]
half = len(y) // 2


def summary(name, track, cost):
    def rms(part, truth):
        return np.sqrt(np.mean((part - truth) ** 2))

    far = np.abs(track[half:] - after) > 0.1 * abs(after - before)
    late = (np.flatnonzero(far)[-1] + 1) * period if far.any() else 0.0
    print(
        f"{name:15} {cost * 1e9:6.0f} ns an update  "
        f"rms error before {rms(track[half // 2 : half], before):.3f}, "
        f"at the end {rms(track[3 * len(y) // 4 :], after):.3f} Nm s/rad; "
        f"follows the step within {late:.1f} s"
    )


rls = padasip.filters.FilterRLS(n=phi.shape[1], mu=1 - 1 / memory, eps=1e-4, w="zeros")
begun = time.perf_counter()
_, _, weights = rls.run(y, phi)
summary("padasip RLS", weights[:, index], (time.perf_counter() - begun) / len(y))

track = np.full(len(y), np.nan)
begun = time.perf_counter()
steps = 10
for at in range(memory, len(y), steps):
    window = slice(at - memory, at)
    theta = np.linalg.lstsq(phi[window], y[window], rcond=None)[0]
    track[at : at + steps] = theta[index]
summary("NumPy, window", track, (time.perf_counter() - begun) / (len(y) - memory) * steps)
