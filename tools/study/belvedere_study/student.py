"""Quantiles of Student's t and areas of the normal distribution, without SciPy."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray


def t_quantile(p: float, df: float) -> float:
    """The value below which a share `p` (from 1/2 on) of Student's distribution lies."""
    low, high = 0.0, 1.0
    while t_below(high, df) < p:
        high *= 2
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if t_below(middle, df) < p else (low, middle)
    return (low + high) / 2


def t_below(t: float, df: float) -> float:
    """The share of Student's distribution below `t >= 0`."""
    return 1 - 0.5 * incomplete_beta(df / (df + t * t), df / 2, 0.5)


def incomplete_beta(x: float, a: float, b: float) -> float:
    """The regularised incomplete beta function, by its continued fraction (Lentz's way)."""
    if x <= 0 or x >= 1:
        return 0.0 if x <= 0 else 1.0
    if x > (a + 1) / (a + b + 2):
        return 1 - incomplete_beta(1 - x, b, a)
    front = math.exp(
        math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)
    )
    tiny, d, value = 1e-300, 1 / (1 - (a + b) * x / (a + 1)), 1.0
    c, value = 1.0, d
    for m in range(1, 400):
        for step in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d = 1 / (1 + step * d or tiny)
            c = 1 + step / c or tiny
            value *= c * d
        if abs(c * d - 1) < 1e-14:
            break
    return front * value / a


def normal_hazard(z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Density over the share that lies above, of the standard normal distribution."""
    above = np.array([0.5 * math.erfc(v / math.sqrt(2)) for v in z])
    density = np.exp(-0.5 * z * z) / math.sqrt(2 * math.pi)
    # Far out the ratio tends to z + 1 / z.
    far = z > 8
    return np.where(far, z + 1 / np.where(far, z, 1.0), density / np.where(above > 0, above, 1.0))
