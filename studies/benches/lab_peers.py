"""The lab's question put to NumPy (the same fit) and to pysindy (which effect is missing).

Reads rows of seven doubles: session, time [s], position [rad], motor torque [Nm],
joint torque [Nm], temperature [degC], inertia [kg m2]. Filters are those of common
practice: Gaussian, zero-phase, the same on every column.
"""

import sys
import time

import numpy as np
import pysindy

SIGMA = 24  # samples: the lab's own width for these data
STRIDE = 48


def smooth(values, order=0, period=1.0):
    """Gaussian of SIGMA, or its derivative of this order."""
    x = np.arange(-4 * SIGMA, 4 * SIGMA + 1)
    gauss = np.exp(-0.5 * (x / SIGMA) ** 2)
    gauss /= gauss.sum()
    taps = {0: gauss, 1: -x * gauss / SIGMA**2, 2: (x**2 - SIGMA**2) * gauss / SIGMA**4}[order]
    return np.convolve(values, taps, "same") / period**order


def rows(samples):
    """Columns of equation (4) and of what may be missing, and the friction, session by session."""
    names = [
        "coulomb", "load_coulomb", "viscous", "quadratic_viscous", "cubic_viscous",
        "stribeck 0.01", "stribeck 0.03", "stribeck 0.1", "constant", "position", "sine", "cosine",
        "acceleration", "load", "load_rate", "temperature_coulomb", "temperature_viscous",
    ]
    blocks = []
    for number in np.unique(samples[:, 0]):
        _, t, q, motor, load, temperature, inertia = samples[samples[:, 0] == number].T
        period = (t[-1] - t[0]) / (len(t) - 1)
        v, a = smooth(q, 1, period), smooth(q, 2, period)
        s, rate, warm = np.sign(v), smooth(load, 1, period), temperature - 8.0
        raw = [
            s, np.abs(load) * s, v, v * np.abs(v), v**3,
            *[np.exp(-((v / width) ** 2)) * s for width in (0.01, 0.03, 0.1)],
            np.ones_like(v), q, np.sin(q), np.cos(q), a, load, rate, warm * s, warm * v,
        ]
        columns = np.column_stack([smooth(column) for column in raw])
        friction = smooth(motor) - smooth(load) - inertia[0] * smooth(a)
        moving = smooth((np.abs(v) > 0.008).astype(float)) > 0.999
        keep = np.flatnonzero(moving)[5 * SIGMA : -5 * SIGMA : STRIDE]
        blocks.append((columns[keep], friction[keep]))
    return names, blocks


def held_out(blocks, columns):
    """RMS [Nm] on sessions left out in turn."""
    error, count = 0.0, 0
    for out in range(len(blocks)):
        rest = [block for number, block in enumerate(blocks) if number != out]
        x = np.vstack([block[0][:, columns] for block in rest])
        y = np.concatenate([block[1] for block in rest])
        coefficients = np.linalg.lstsq(x, y, rcond=None)[0]
        error += np.sum((blocks[out][1] - blocks[out][0][:, columns] @ coefficients) ** 2)
        count += len(blocks[out][1])
    return np.sqrt(error / count)


def main():
    samples = np.fromfile(sys.argv[1]).reshape(-1, 7)
    begun = time.perf_counter()
    names, blocks = rows(samples)
    base = [names.index(name) for name in names[:5]]
    rms = held_out(blocks, base)
    print(f"NumPy     {time.perf_counter() - begun:7.3f} s   held out {rms:.4f} Nm with equation (4)")

    x = np.vstack([block[0] for block in blocks])
    y = np.concatenate([block[1] for block in blocks])
    scale = np.sqrt(np.mean(x**2, axis=0))
    for threshold in (0.05, 0.2, 1.0):
        begun = time.perf_counter()
        optimizer = pysindy.STLSQ(threshold=threshold, alpha=1e-6)
        optimizer.fit(x / scale, y[:, None])
        found = [name for name, own in zip(names, optimizer.coef_[0]) if own != 0.0]
        extra = [name for name in found if name not in names[:5]]
        lost = [name for name in names[:5] if name not in found]
        took = time.perf_counter() - begun
        print(f"pysindy   {took:7.3f} s   threshold {threshold}: adds {extra or 'nothing'}, drops {lost or 'nothing'}")


if __name__ == "__main__":
    main()
