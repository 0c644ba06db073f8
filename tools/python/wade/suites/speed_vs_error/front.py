"""The front of undominated points: no other one is at most as dear and at most as wrong, and better in one of both."""


def front(points):
    """Flags, one a point: whether it lies on the front.

    points: list of (cost, error); an error of None has no place in the comparison and is never on the front. Of points
    that are equal in both all are on the front.
    """
    known = [(c, e) for c, e in points if e is not None]
    flags = []
    for cost, error in points:
        if error is None:
            flags.append(False)
            continue
        flags.append(not any(c <= cost and e <= error and (c < cost or e < error) for c, e in known))
    return flags


def cheapest_below(points, limit):
    """Index of the cheapest point with an error of at most `limit`, or None.

    points: as above.
    """
    fitting = [(cost, error, i) for i, (cost, error) in enumerate(points) if error is not None and error <= limit]
    return min(fitting)[2] if fitting else None


def distance_to_front(points, index):
    """How far a point lies from the front, as two factors of at least 1.

    (cost of the point / cost of the cheapest point that is at most as wrong,
     error of the point / smallest error of the points that are at most as dear)
    """
    cost, error = points[index]
    cheapest = cheapest_below(points, error)
    best = min(e for c, e in points if e is not None and c <= cost)
    return cost / points[cheapest][0], (error / best if best > 0 else 1.0)
