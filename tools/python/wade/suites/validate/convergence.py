"""Observed order of convergence."""

import math

NOISE = 1e-5  # errors below it are rounding of single precision, not of the method
GOODNESS = 0.8  # part of the variance of log(error) that the straight line must explain


def order(spacings, errors):
    """Slope of log(error) over log(spacing) by least squares; None where the errors do not fall with the spacing, that is
    where another part of the error, or chance, is larger than that of the spacing."""
    points = [(d, e) for d, e in zip(spacings, errors) if e is not None and d > 0]
    if len(points) < 3 or any(not math.isfinite(e) or e < NOISE for _, e in points):
        return None
    x = [math.log(d) for d, _ in points]
    y = [math.log(e) for _, e in points]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    xx = sum((a - mean_x) ** 2 for a in x)
    yy = sum((b - mean_y) ** 2 for b in y)
    xy = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y))
    if xx == 0 or yy == 0 or xy * xy < GOODNESS * xx * yy or xy < 0:
        return None
    return xy / xx
