"""``cmverify stability``: verdicts of solids, maps of stability, polar plots."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cmverify.console import refuse

if TYPE_CHECKING:
    from cmverify.case import Array
    from cmverify.studies.stability.assessments import Assessment
    from cmverify.studies.stability.page import Section


class Study(StrEnum):
    """What can be mapped."""

    POISSON = "poisson"
    ORTHOTROPIC = "orthotropic"
    CONDUCTION = "conduction"
    REPRESENTABLE = "representable"
    POLAR = "polar"


class Fineness(StrEnum):
    """Seconds, or a minute or two."""

    QUICK = "quick"
    STANDARD = "standard"


class AreaRules(StrEnum):
    """See `solver.Family`."""

    PARTIAL = "partial"
    FULL = "full"
    EXACT = "exact"


def stability(
    material: Annotated[
        list[str] | None,
        typer.Option(
            help="Solid: a name, isotropic:NU[:strain] or C11,C22,C12,C66[,C16,C26]; @DEGREES "
            "turns it. May be given again; without any the suite's."
        ),
    ] = None,
    study: Annotated[
        list[Study] | None, typer.Option(help="Maps to draw; may be given again.")
    ] = None,
    m: Annotated[float, typer.Option(help="Horizon in cells.")] = 5,
    area_rule: Annotated[AreaRules, typer.Option(help="Area rule.")] = AreaRules.PARTIAL,
    level: Annotated[Fineness, typer.Option(help="How fine the maps are.")] = Fineness.QUICK,
    out: Annotated[
        Path, typer.Option("--out", help="Folder of stability.html and figures.")
    ] = Path("report"),
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an earlier page and its figures.")
    ] = False,
) -> None:
    """Say how stable solids are with every calibration, and map it.

    With --material: verdicts and polar plots of these solids, and only the studies asked for.
    Exit code 1 if a verdict is not confirmed by bond energies or linear programming.
    """
    from cmverify.cases.common import materials
    from cmverify.console import console
    from cmverify.run import folder
    from cmverify.studies.stability import page
    from cmverify.studies.stability.assessments import compare

    screen = console()
    try:
        earlier = [out / "stability.html", *sorted(out.glob("stability-*.png"))]
        folder.keep(earlier, overwrite, folder.OTHER_OUT)
        solids = {name: materials.named(name) for name in material} if material else _suite()
        verdicts = [
            verdict
            for name, tensor in solids.items()
            for verdict in compare(name, tensor, m, area_rule.value)
        ]
        folder.check_file(out / "stability.html")
    except ValueError as error:
        refuse(str(error))
    _print(screen, verdicts)
    chosen = study or ([] if material else list(Study))
    fine = level == Fineness.STANDARD
    sections = []
    for one in chosen:
        with screen.status(f"mapping: {one.value}"):
            sections.append(_section(one, fine))
    if material:
        sections.append(_polar({k: v for k, v in solids.items() if v.shape == (3, 3)}, m))
    parts = ["cmverify stability", *(f"--material '{name}'" for name in material or ())]
    parts += [f"--study {one.value}" for one in study or ()]
    parts.append(f"--m {m:g} --area-rule {area_rule} --level {level} --out {out}")
    path = page.write(verdicts, sections, " ".join(parts), out)
    good = page.all_confirmed(verdicts)
    said = "Every verdict is confirmed." if good else "Some verdicts are not confirmed."
    screen.print(said, style="bold green" if good else "bold red")
    screen.print(f"Page: {path}", soft_wrap=True)
    raise typer.Exit(0 if good else 1)


def _suite() -> dict[str, Array]:
    """Solids of the verdict table: those of the hard cases."""
    from cmverify.cases.common import materials
    from cmverify.cases.hard.tensors import forty_to_one

    stress = {f"ν = {nu:g}": materials.isotropic(nu) for nu in (-0.5, 0.2, 0.35, 0.49, 0.499)}
    third = {"ν = 1/3": materials.isotropic(1 / 3)}
    strain = {
        f"ν = {nu:g}, plane strain": materials.isotropic(nu, "strain")
        for nu in (0.36, 0.375, 0.38, 0.4)
    }
    ply = materials.TENSORS["carbon/epoxy"]
    turned = {f"carbon/epoxy {a}°": materials.turned(ply, a) for a in (0, 30, 45)}
    rest = {n: materials.TENSORS[n] for n in ("silicon", "bone", "fully anisotropic")}
    return {
        **stress, **third, **strain, **turned, "40 : 1": forty_to_one(), **rest,
        "tetrachiral": materials.tetrachiral(),
    }  # fmt: skip


def _print(screen, verdicts: list[Assessment]) -> None:  # type: ignore[no-untyped-def]
    from rich.text import Text

    from cmverify.console import columns, mark, show

    numbers = ("m", "margin", "lowest", "highest")
    rows: list[tuple[str | Text, ...]] = []
    for v in verdicts:
        colour = "green" if v.stable else "red" if v.kind == "inadmissible" else "yellow"
        values = [
            "–" if value != value else f"{value:.3g}" for value in (v.margin, v.lowest, v.highest)
        ]
        verdict = Text(v.kind, style=colour).append(", bonds ≥ 0" if v.non_negative else "")
        rows.append(
            (mark(v.confirmed), v.solid, v.calibration, verdict, f"{v.m:g}", *values,
             v.law or "default")
        )  # fmt: skip
    head = columns("", "solid", "calibration", "verdict", *numbers, "law", right=numbers)
    show(screen, head, rows, keys=3)


def _section(study: Study, fine: bool) -> Section:
    from cmverify.report.picture import Picture
    from cmverify.studies.stability import figures, polar, studies
    from cmverify.studies.stability.page import Section, spoken

    if study is Study.POISSON:
        found = studies.poisson(fine)
        limits = {m: studies.poisson_limit(m) for m in (2, 3, 4, 5, 7)}
        said = ", ".join(f"{limit:.4f} at m = {m}" for m, limit in limits.items())
        text = (
            "Isotropic solids are stable to ν = 1/2 in plane stress although their shear bonds "
            f"are negative beyond ν = 1/3. In plane strain the limit is {said}."
        )
        alt = "; ".join(f"{one.title}: {spoken(one.margin)}" for one in found)
        picture = Picture.drawn(
            "stability-poisson", "png", figures.poisson(found, limits[5]),
            "Margin over Poisson's ratio and horizon, lattice calibration.", alt, wide=True,
        )  # fmt: skip
        return Section("Poisson's ratio and horizon", text, (picture,))
    if study is Study.REPRESENTABLE:
        shares = studies.representability(fine)
        text = (
            f"Of {shares.count} random positive-definite tensors "
            f"{100 * shares.shares[2]:.0f} % have non-negative bonds at m = 3, "
            f"{100 * shares.shares[-1]:.0f} % at m = 10, and "
            f"{100 * shares.never:.0f} % at no m: C66 ≥ C12 is necessary, not sufficient."
        )
        picture = Picture.drawn(
            "stability-representable", "png", figures.representability(shares),
            "Smallest m with non-negative, exact bond moduli (ν12 = 1/4), and shares of random "
            "tensors.", text, wide=True,
        )  # fmt: skip
        return Section("Which tensors non-negative bonds can make", text, (picture,))
    if study is Study.POLAR:
        from cmverify.cases.common import materials

        names = ("Fig. 2", "bone")
        section = _polar({name: materials.TENSORS[name] for name in names}, 5)
        picture = Picture.drawn(
            "stability-fig3", "png", figures.over_poisson(polar.over_poisson()),
            "Macro- and micromoduli over Poisson's ratio, as in Fig. 3.",
            "k_n stays positive, k_t falls through zero at one third.", wide=False,
        )  # fmt: skip
        return Section(section.title, section.text, (*section.pictures, picture))
    if study is Study.ORTHOTROPIC:
        found = studies.orthotropic(fine)
        name, title = "stability-orthotropic", "Orthotropic solids"
        caption = f"Margin over E1/E2 and G12/E2, ν12 = {studies.NU12:g}, m = 5, by calibration."
        text = (
            "The paper's law loses the rotation stiffness of stiff plies; non-negative bonds keep "
            "them stable, but for a strip where so few of them resist shear that rotations of "
            "alternating sign strain none (law=UniformShear() spreads the shear)."
        )
    else:
        found = studies.conduction(fine)
        name, title = "stability-conduction", "Anisotropic conductors"
        caption = "Margin over ratio and angle of the principal axis, m = 3, by calibration."
        text = (
            "At m = 3 there are few directions: between the lattice's axes the cosine law goes "
            "negative or cannot be calibrated, and non-negative bonds do not exist; larger m help."
        )
    alt = "; ".join(f"{one.title}: {spoken(one.margin)}" for one in found)
    log = (True, study is Study.ORTHOTROPIC)
    return Section(
        title,
        text,
        (Picture.drawn(name, "png", figures.maps(found, log), caption, alt, wide=True),),
    )


def _polar(solids: dict[str, Array], m: float) -> Section:
    from cmverify.report.picture import Picture
    from cmverify.studies.stability import figures, polar
    from cmverify.studies.stability.page import Section

    pictures = tuple(
        Picture.drawn(
            f"stability-polar-{index + 1}", "png", figures.polar(polar.polar(name, voigt, m)),
            f"{name}: moduli over the direction, as in Fig. 2; markers are the bonds at m = {m:g}.",
            f"Polar plots of macro- and micromoduli of {name}.", wide=True,
        )
        for index, (name, voigt) in enumerate(solids.items())
    )  # fmt: skip
    text = (
        "Curves are the closed forms of Eqs. 45, 48–49 and 65–70, over the largest value; the "
        "continuum calibration's bonds lie on them, the others where the lattice's sums want them."
    )
    return Section("Macro- and micromoduli over the direction", text, pictures)
