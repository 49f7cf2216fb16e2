"""What a scene will cost, estimated from a few numbers before any of it is spent.

The constants are measured: memory and times of scenes from 400 to 160,000 particles and horizons
of 2 to 80 cells on one core of a common machine, within a factor of two.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

#: Longest estimate (s) that is accepted without being asked for.
SECONDS = 900.0
# Estimate (s) from which on it is told.
_LONG = 20.0
#: Share of the memory that is free which a scene may take.
SHARE = 0.8

# Products of the operator in a solve: iterations of about 30, V-cycles of five products.
_PRODUCTS = 200
# Seconds a bond in a product, an offset of the family in the stability check, a bond of a particle
# near the edge in the set-up, a bond that ends at the surface, one beside a corner that is tried
# for what the corner cuts out of it, and what is found so (a chord).
_PRODUCT, _OFFSET, _EDGE, _ENDED, _TRIED, _CHORD = 1e-9, 3e-4, 3e-7, 1e-5, 6e-8, 2.5e-5
# The same in bytes, and of a particle's unknown.
_OFFSET_BYTES, _EDGE_BYTES, _ENDED_BYTES, _UNKNOWN_BYTES = 4e4, 24.0, 500.0, 300.0
_CHORD_BYTES = 2000.0
# Share of the tried bonds that are chords at a corner of a large body, and what it grows by where
# the horizon is twice as long as the body is wide: then they pass through from side to side.
_CUT, _THROUGH = 0.008, 0.03


@dataclass(frozen=True)
class Cost:
    """Size of a scene, and what it takes.

    Attributes
    ----------
    particles, family : float
        Number of particles and of bonds of each.
    ended, chords : float
        Bonds that end at edges, faces of cracks and interfaces; and those that corners cut out of
        bonds between missing particles.
    memory : float, bytes
    seconds : float
        Of set-up and one solve.
    """

    particles: float
    family: float
    ended: float
    chords: float
    memory: float
    seconds: float

    @property
    def told(self) -> str:
        """What it is expected to take, where that is long; an empty string elsewhere."""
        if self.seconds < _LONG:
            return ""
        return f"{self._size}: to set up and to solve once takes about {_time(self.seconds)}"

    @property
    def _size(self) -> str:
        return f"about {_count(self.particles)} particles with {_count(self.family)} bonds each"

    def refusal(self, memory: float, seconds: float) -> str:
        """Why it is too much, or an empty string.

        Parameters
        ----------
        memory, seconds : float
            Bytes and seconds that may be spent.
        """
        size = self._size
        if self.memory > memory:
            return f"{size} need {_bytes(self.memory)} of memory, and {_bytes(memory)} may be used"
        if self.seconds > seconds:
            return f"{size} take {_time(self.seconds)}, and {_time(seconds)} may be spent"
        return ""


@dataclass(frozen=True)
class Edge:
    """Where bonds may end.

    Attributes
    ----------
    length : float, m
    corners : int
        That turn inwards, seen along it with the body on the left.
    """

    length: float
    corners: int


def estimate(
    width: float,
    height: float,
    spacing: float,
    m: float,
    components: int,
    surface: str,
    crack_length: float = 0.0,
    growing: bool = False,
    edge: Edge | None = None,
    interfaces: Edge | None = None,
) -> Cost:
    """Cost of a body of these outer dimensions.

    A horizon may be longer than the body: then no bond is missing that its particles have not,
    and nearly all of theirs end somewhere.

    Parameters
    ----------
    width, height : float
        Of the box around the body, m.
    spacing : float
        Δx, m.
    m : float
        Horizon in cells.
    components : int
        Unknowns of a particle.
    surface : str
        Treatment of surfaces.
    crack_length : float
        Of all cracks, m.
    growing : bool
        Whether cracks are to grow: then every bond has a state.
    edge : Edge, optional
        Of the body; that of a rectangle by default.
    interfaces : Edge, optional
        Between its materials, seen from both sides: bonds end there with every treatment.
    """
    columns, rows = width / spacing + 1, height / spacing + 1
    particles, family = columns * rows, max(pi * m**2, 4.0)
    grid = (columns + 2 * m + 4) * (rows + 2 * m + 4)
    edge = edge or Edge(2 * (width + height), 4)
    inner = interfaces or Edge(0.0, 0)
    rim = (edge.length + 2 * crack_length) / spacing + 4
    depth = {"none": 0.0, "volume": 2 * m, "extrapolated": m}[surface]
    near = min(particles, rim * depth + (crack_length + inner.length) / spacing * 2 * m)
    extrapolated = surface == "extrapolated"
    ends = rim * extrapolated + inner.length / spacing
    # 0.21 m F bonds cross a cell's length of a straight edge.
    ended = min(ends * 0.21 * m, particles) * family
    # Of every cell within a horizon of a corner half of the bonds.
    corners = edge.corners * extrapolated + inner.corners
    tried = 0.5 * family * min(corners * (2 * m + 3) ** 2, grid)
    chords = tried * (_CUT + _THROUGH * min(max(m / min(columns, rows) - 1.0, 0.0), 1.0))
    bonds = particles * family
    memory = _OFFSET_BYTES * family + _UNKNOWN_BYTES * particles * components + 50 * grid
    memory += _EDGE_BYTES * near * family + _ENDED_BYTES * ended + 16 * bonds * growing
    memory += _CHORD_BYTES * chords
    seconds = _OFFSET * family + _EDGE * near * family + _ENDED * ended
    seconds += _TRIED * tried + _CHORD * chords
    seconds += _PRODUCT * _PRODUCTS * bonds
    return Cost(particles, family, ended, chords, memory, seconds)


def free_memory() -> float:
    """Bytes that this process may take: what the machine, and a control group, have left."""
    import psutil

    free = float(psutil.virtual_memory().available)
    try:
        with (
            open("/sys/fs/cgroup/memory.max") as most,
            open("/sys/fs/cgroup/memory.current") as now,
        ):
            free = min(free, float(most.read()) - float(now.read()))
    except (OSError, ValueError):  # no limit, or another system
        pass
    return max(free, 0.0)


def _count(value: float) -> str:
    return f"{value:,.0f}" if value < 1e9 else f"{value:.1e}"


def _bytes(value: float) -> str:
    for unit in ("KiB", "MiB", "GiB", "TiB"):
        value /= 1024
        if value < 1024:
            return f"{value:.3g} {unit}"
    return f"{value:.3g} TiB"


def _time(seconds: float) -> str:
    for size, unit in ((1.0, "s"), (60.0, "min"), (3600.0, "h"), (86400.0, "days")):
        if seconds < 120 * size or unit == "days":
            return f"{seconds / size:.3g} {unit}"
    return ""
