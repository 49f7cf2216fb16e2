"""Slow and independent: where straight lines run, in fractions."""

from fractions import Fraction
from itertools import pairwise


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def minus(a, b):
    return a[0] - b[0], a[1] - b[1]


def on_segment(point, a, b):
    """Whether a point lies on a closed segment."""
    along, away = minus(b, a), minus(point, a)
    if cross(along, away) != 0:
        return False
    dot = along[0] * away[0] + along[1] * away[1]
    return 0 <= dot <= along[0] ** 2 + along[1] ** 2


def shares(p, q, a, b):
    """Shares of the line from p to q at which it meets the segment a b, ends of an overlap too."""
    d, e = minus(q, p), minus(b, a)
    area = cross(d, e)
    if area != 0:
        share = Fraction(cross(minus(a, p), e), area)
        place = Fraction(cross(minus(a, p), d), area)
        return [share] if 0 <= share <= 1 and 0 <= place <= 1 else []
    size = d[0] ** 2 + d[1] ** 2
    found = []
    for point in (a, b):
        away = minus(point, p)
        if cross(d, away) == 0:
            share = Fraction(d[0] * away[0] + d[1] * away[1], size)
            if 0 <= share <= 1:
                found.append(share)
    return found


def held(point, rings):
    """Whether a point is inside a body with these rings, or on its edge."""
    inside = False
    for ring in rings:
        for a, b in zip(ring, [*ring[1:], ring[0]], strict=True):
            if on_segment(point, a, b):
                return True
            if (a[1] > point[1]) != (b[1] > point[1]):
                at = a[0] + Fraction(b[0] - a[0]) * (point[1] - a[1]) / (b[1] - a[1])
                inside ^= at > point[0]
    return inside


def stays_inside(p, q, rings):
    """Whether the line from p to q runs in the body or along its edge."""
    met = {Fraction(0), Fraction(1)}
    for ring in rings:
        for a, b in zip(ring, [*ring[1:], ring[0]], strict=True):
            # Nothing is met where one lies beside the other.
            extents = [(*sorted([a[k], b[k]]), *sorted([p[k], q[k]])) for k in (0, 1)]
            if all(low <= far and near <= high for low, high, near, far in extents):
                met.update(shares(p, q, a, b))
    for low, high in pairwise(sorted(met)):
        middle = (low + high) / 2
        point = tuple(x + middle * (y - x) for x, y in zip(p, q, strict=True))
        if not held(point, rings):
            return False
    return True


# A displacement far smaller than what distinguishes points on a grid of eighths.
TINY = Fraction(1, 2**14)


def directions(point, pieces):
    """Directions in which pieces run on from a point, up to length."""
    found = []
    for a, b in pieces:
        if not on_segment(point, a, b):
            continue
        for end in (a, b):
            ray = minus(end, point)
            if ray != (0, 0) and not any(
                cross(ray, other) == 0 and ray[0] * other[0] + ray[1] * other[1] > 0
                for other in found
            ):
                found.append(ray)
    return found


def is_cut(p, q, pieces):
    """Whether pieces part p from q: tips do not, and who lies on a piece lies above it."""

    def as_it_counts(point):
        if len(directions(point, pieces)) < 2:
            return point
        return point[0] + TINY**2, point[1] + TINY

    p, q = as_it_counts(p), as_it_counts(q)
    d = minus(q, p)
    for a, b in pieces:
        if cross(d, minus(b, a)) == 0:
            continue
        for share in shares(p, q, a, b):
            met = p[0] + share * d[0], p[1] + share * d[1]
            if len(directions(met, pieces)) != 1:
                return True
    return False
