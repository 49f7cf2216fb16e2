"""``cmverify material``: what to know of a solid before choosing a model of it."""

from __future__ import annotations

import json as to_json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from cmverify.console import refuse

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.console import Console

    from cmverify.case import Array
    from cmverify.studies.anisotropy.profile import Profile


def material(
    solid: Annotated[
        str | None,
        typer.Argument(
            metavar="[SOLID]",
            help="A scene file, or a name as in cmverify stability: silicon, isotropic:0.3, …",
        ),
    ] = None,
    isotropic: Annotated[str | None, typer.Option(help="E,nu")] = None,
    orthotropic: Annotated[
        str | None, typer.Option(help="E1,E2,nu12,G12; in plane strain E3,nu13,nu23 as well.")
    ] = None,
    voigt: Annotated[str | None, typer.Option(help="C11,C12,C16,C22,C26,C66")] = None,
    compliance: Annotated[str | None, typer.Option(help="S11,S12,S16,S22,S26,S66")] = None,
    strain: Annotated[bool, typer.Option("--strain", help="Plane strain, not stress.")] = False,
    angle: Annotated[float, typer.Option(help="Turn it anticlockwise, degrees.")] = 0.0,
    density: Annotated[float, typer.Option(help="kg/m³, for wave speeds.")] = 1.0,
    m: Annotated[float, typer.Option(help="Horizon in cells.")] = 5.0,
    out: Annotated[Path | None, typer.Option(help="Figure to write, .png, .svg or .pdf.")] = None,
    json: Annotated[Path | None, typer.Option(help="File to write all numbers to.")] = None,
    page: Annotated[
        Path | None,
        typer.Option(
            help="Write materials.html to this folder, a report's; without a solid, "
            "of all elastic solids of the cases."
        ),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace these files.")] = False,
) -> None:
    """Say what bonds make of a solid, what to expect of it, and which calibration to use."""
    from cmverify.console import console
    from cmverify.run import results
    from cmverify.run.folder import FolderError, keep
    from cmverify.studies.anisotropy.profile import profile

    try:
        keep([path for path in (out, json) if path is not None], overwrite)
    except FolderError as error:
        refuse(str(error))
    if out is not None and out.suffix not in (".png", ".svg", ".pdf"):
        refuse(f"--out {out}: a figure is a .png, .svg or .pdf")
    given = {"--isotropic": isotropic, "--orthotropic": orthotropic, "--voigt": voigt,
             "--compliance": compliance, "SOLID": solid}  # fmt: skip
    said = {name: text for name, text in given.items() if text is not None}
    if page is not None and not said and out is None and json is None:
        _page_of_the_cases(page, m, density, overwrite)
        return
    if len(said) != 1:
        refuse(f"give one solid: {', '.join(given)}")
    form, text = next(iter(said.items()))
    try:
        name = text if form == "SOLID" else f"{form[2:]} {text}"
        name += ", plane strain" * strain + f", turned by {angle:g}°" * bool(angle)
        found = profile(name, tensor(form, text, strain, angle), m, density)
        for path in (out, json):
            if path is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
        if json is not None:
            told = to_json.dumps(found.as_dict(), indent=1, ensure_ascii=False)
            results.write_text(json, told + "\n")
        if out is not None:
            _figure(found, out)
        if page is not None:
            _page([found], page, f"{form.replace('SOLID', '')} {text}".strip(), overwrite)
    except ValueError as error:
        refuse(" ".join(str(error).split()))
    except OSError as error:
        refuse(f"{error.filename or out or json} cannot be written: {error.strerror or error}")
    show_all(console(), found)
    for path in (out, json):
        if path is not None:
            console().print("wrote", str(path), soft_wrap=True)


def _page(found: Iterable[Profile], folder: Path, said: str, overwrite: bool) -> None:
    from cmverify.console import console
    from cmverify.run.folder import OTHER_OUT, check_file, keep
    from cmverify.studies.anisotropy import page

    path = folder / page.NAME
    keep([path], overwrite, OTHER_OUT.replace("--out", "--page"))
    check_file(path)
    command = " ".join(part for part in ("cmverify material", said, f"--page {folder}") if part)
    console().print(f"Page: {page.write(found, command, folder)}", soft_wrap=True)


def _page_of_the_cases(folder: Path, m: float, density: float, overwrite: bool) -> None:
    from cmverify.studies.anisotropy.page import of_the_cases
    from cmverify.studies.anisotropy.profile import profile

    try:
        # One after the other, after the folder has been tried.
        solids = (profile(name, voigt, m, density) for name, voigt in of_the_cases())
        _page(solids, folder, f"--m {m:g}", overwrite)
    except ValueError as error:
        refuse(" ".join(str(error).split()))
    except OSError as error:
        refuse(f"{error.filename or folder} cannot be written: {error.strerror or error}")


def tensor(form: str, text: str, strain: bool, angle: float) -> Array:
    """The (3, 3) stiffness of a solid in one of the forms of the command line.

    Raises
    ------
    ValueError
        If the text makes no solid.
    """
    import numpy as np

    from cmverify.cases.common import materials
    from solver import ElasticTensor

    if form == "SOLID":
        if strain:
            raise ValueError("--strain goes with --isotropic and --orthotropic")
        if text.endswith(".toml"):
            solid = _of_file(Path(text))
        else:
            solid = ElasticTensor(materials.named(text))
    else:
        numbers = _numbers(form, text)
        plane: Literal["stress", "strain"] = "strain" if strain else "stress"
        if strain and form in ("--voigt", "--compliance"):
            raise ValueError(f"{form} is of the plane problem already: leave --strain out")
        if form == "--isotropic":
            young, poisson = _so_many(form, numbers, 2)
            solid = ElasticTensor.isotropic(young, poisson, plane)
        elif form == "--orthotropic":
            e1, e2, nu12, g12, *third = _so_many(form, numbers, 7 if strain else 4)
            rest = dict(zip(("E3", "nu13", "nu23"), third, strict=True)) if strain else {}
            solid = ElasticTensor.orthotropic(e1, e2, g12, nu12, plane=plane, **rest)
        else:
            upper = _so_many(form, numbers, 6)
            matrix = np.zeros((3, 3))
            matrix[np.triu_indices(3)] = upper
            matrix += np.triu(matrix, 1).T
            whole = form == "--voigt"
            solid = ElasticTensor(matrix) if whole else ElasticTensor.of_compliance(matrix)
    if not np.isfinite(angle):
        raise ValueError(f"--angle {angle}: degrees are a finite number")
    return np.array(solid.rotated(np.radians(angle)).voigt if angle else solid.voigt)


def _of_file(path: Path):  # type: ignore[no-untyped-def]
    from cmverify.exchange import scene_file
    from solver import ElasticTensor

    scene, _ = scene_file.read(path)
    if not isinstance(scene.material, ElasticTensor):
        raise ValueError(f"{path}: [material] is no elastic solid; conductors: cmverify stability")
    return scene.material


def _numbers(form: str, text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise ValueError(f"{form} {text}: numbers with commas between them") from None


def _so_many(form: str, numbers: list[float], count: int) -> list[float]:
    if len(numbers) != count:
        raise ValueError(f"{form} takes {count} numbers here, not {len(numbers)}")
    return numbers


def _figure(found: Profile, out: Path) -> None:
    from cmverify.studies.anisotropy.figure import draw
    from solver.result import replacing

    with replacing(out) as partial:
        draw(found).savefig(partial, format=out.suffix[1:], dpi=110)


def show_all(screen: Console, found: Profile) -> None:
    """Tables of everything, and the advice."""
    import numpy as np

    from cmverify.console import columns, show
    from cmverify.studies.anisotropy.profile import DIRECTIONS, HORIZONS, MIXITIES, lines, ripple

    rows = [[*(f"{v:.6g}" for v in row)] for row in found.voigt]
    show(screen, columns("11", "22", "12", right=("11", "22", "12")), rows, "stiffness, Pa", keys=0)
    names = tuple(found.micromoduli)
    show(
        screen, columns(*names, right=names), [[f"{v:.4g}" for v in found.micromoduli.values()]],
        "micromoduli of Eqs. 65–70 for a horizon of 1 m, N/m⁵", keys=0,
    )  # fmt: skip
    rows = [[row.name, row.kind, row.margin, row.negative, *row.margins] for row in lines(found)]
    horizons = [f"m = {h}" for h in HORIZONS]
    show(
        screen,
        columns("calibration", "operator", "margin", "negative bonds", *horizons,
                right=("margin", *horizons)),
        rows, f"bonds at m = {found.m:g}, and margins of stability over m",
    )  # fmt: skip
    which = ", ".join(str(h) for h in found.admissible) or "none"
    horizons_told = f"{HORIZONS[0]} … {HORIZONS[-1]}"
    screen.print(
        f"exact moduli, none of them negative, exist at m = {which} (of {horizons_told})",
        soft_wrap=True,
    )
    said = ", ".join(f"{name} {ripple(ratio):.2g}" for name, (_, ratio) in found.energies.items())
    screen.print(f"largest error of W/W_exact as the material turns: {said}", soft_wrap=True)
    chosen = [0, 3, 6, 9, 12, 15, 18]
    shown = [f"{MIXITIES[k]:.0f}°" for k in chosen]
    show(
        screen, columns(*shown, right=shown), [[f"{found.kinks[k]:.1f}°" for k in chosen]],
        "kink of a crack along axis 1 over the mixity atan(K_II/K_I), hoop criterion", keys=0,
    )  # fmt: skip
    rows = [
        [f"{np.degrees(DIRECTIONS[k]):.0f}°", *(f"{v:.5g}" for v in found.speeds[k]),
         f"{found.hole[k]:.4g}", f"{found.crack[k]:.5g}"]
        for k in range(0, 73, 12)
    ]  # fmt: skip
    numbers = ("fast wave, m/s", "slow wave, m/s", "hole, hoop over tension", "crack, K_I²/G (Pa)")
    title = f"by direction (waves at {found.density:g} kg/m³)"
    show(screen, columns("direction", *numbers, right=numbers), rows, title)
    screen.print(found.advice)
