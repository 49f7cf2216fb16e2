"""Ask LAMMPS's peridynamics (package PERI) a case of cmverify, and write what it answers.

    cmverify export isotropic-hole --out problem
    python lammps_peri.py problem fields.npz
    cmverify compare isotropic-hole fields.npz

A slab of seven layers, periodic across, is plane strain: nothing moves out of the plane. The layer
is put where the case holds it, the rest follows by the minimiser. Needs the program ``lmp``.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

LAYERS = 7  # thicker than two horizons, or a particle would meet itself
SMALL = 1e-4  # of the displacement, so that the answer is linear

SCRIPT = """
units si
atom_style peri
atom_modify map array sort 0 0
boundary s s p
lattice sc {spacing:.17g}
read_data body.data
pair_style peri/pmb
pair_coeff * * {constant:.12g} {horizon:.12g} 1e6 0
neighbor {skin:.12g} bin
set group all density 1
set group all volume {volume:.12g}
group held type 2
timestep 1e-6
thermo 50
thermo_modify flush yes
run 0
variable u1 atomfile u1.txt
variable u2 atomfile u2.txt
displace_atoms all move v_u1 v_u2 0 units box
fix plane all setforce NULL NULL 0
fix still held setforce 0 0 0
min_style cg
min_modify line forcezero
minimize 0 {force:.6g} 3000 30000
write_dump all custom moved.txt id x y modify format float %.17g sort id
"""


def columns(path: str, values: np.ndarray) -> None:
    """A LAMMPS atomfile."""
    rows = "\n".join(f"{i + 1} {v:.17g}" for i, v in enumerate(values))
    Path(path).write_text(f"{len(values)}\n{rows}\n")


def main(folder: str, answer: str) -> None:
    """Solve the problem in `folder` with pair style peri/pmb."""
    problem = json.loads(Path(folder, "case.json").read_text(encoding="utf-8"))
    given = np.load(Path(folder, "particles.npz"))
    points, held, dx = given["points"], given["held_u1"], problem["spacing"]
    exact = np.nan_to_num(np.stack([given["value_u1"], given["value_u2"]], axis=1))
    # The start: the linear field that fits what is held.
    basis = np.column_stack([points, np.ones(len(points))])
    start = basis @ np.linalg.lstsq(basis[held], exact[held], rcond=None)[0]
    u = SMALL * np.where(held[:, None], exact, start)
    count = len(points)
    z = np.repeat((np.arange(LAYERS) + 0.5) * dx, count)
    x, y = np.tile(points, (LAYERS, 1)).T
    kind = np.tile(np.where(held, 2, 1), LAYERS)
    (x0, y0), (x1, y1) = points.min(axis=0) - dx, points.max(axis=0) + dx
    head = (
        f"body\n\n{LAYERS * count} atoms\n2 atom types\n{x0} {x1} xlo xhi\n{y0} {y1} ylo yhi\n"
        f"0 {LAYERS * dx:.17g} zlo zhi\n\nAtoms # peri\n\n"
    )
    rows = zip(kind, x, y, z, strict=True)
    atoms = (
        f"{i} {k} {dx**3:.12g} 1 {a:.17g} {b:.17g} {c:.17g}"
        for i, (k, a, b, c) in enumerate(rows, 1)
    )
    Path("body.data").write_text(head + "\n".join(atoms) + "\n")
    for name, component in zip(("u1.txt", "u2.txt"), u.T, strict=True):
        columns(name, np.tile(component, LAYERS))
    horizon = problem["horizon"] * (1 + 1e-9)
    constant = 18 * (2 / 3) / (np.pi * horizon**4)  # of the bulk modulus at E = 1, ν = 1/4
    text = SCRIPT.format(
        constant=constant, horizon=horizon, skin=0.1 * dx, volume=dx**3, spacing=dx,
        force=1e-5 * SMALL * dx**2,
    )  # fmt: skip
    Path("peri.in").write_text(text)
    begun = time.perf_counter()
    subprocess.run(["lmp", "-in", "peri.in", "-screen", "none"], check=True)
    seconds = time.perf_counter() - begun
    moved = np.loadtxt("moved.txt", skiprows=9)[:, 1:].reshape(LAYERS, count, 2).mean(axis=0)
    np.savez(
        answer, points=points, displacement=(moved - points) / SMALL, seconds=seconds,
        unknowns=3 * LAYERS * int((~held).sum()),
    )  # fmt: skip


if __name__ == "__main__":
    main(*sys.argv[1:])
