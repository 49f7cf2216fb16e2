import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from references import provenance
from references.__main__ import app
from references.catalogue import catalogue
from references.fem.mesh import disc
from references.provenance import (
    DATA,
    DamagedReferenceError,
    Generated,
    Reference,
    build,
    compare_with_catalogue,
    load,
    regenerate_and_compare,
)


def squares(numbers: list[int], factor: float = 1.0) -> Generated:
    n = np.array(numbers, dtype=float)
    return Generated(
        {"n": n, "squares": factor * n**2}, {"n": 0.0, "squares": 1e-3}, (disc(0.5),), 1
    )


EXAMPLE = Reference(
    "squares", "Squares", "nobody (2020)", squares, {"numbers": [1, 2, 3]}, {"numbers": [3, 2]}, "n"
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    build(EXAMPLE, tmp_path)
    return tmp_path


def test_the_record_says_how_the_numbers_came_about(folder: Path) -> None:
    stored = load("squares", folder)
    assert stored["squares"].tolist() == [1, 4, 9]
    record = stored.record
    assert record["generator"].endswith("squares")
    assert record["arguments"] == {"numbers": [1, 2, 3]}
    assert record["meshes"][0]["sha256"] == disc(0.5).sha256
    assert record["element_order"] == 1
    assert stored.error("squares") == 1e-3
    assert {"python", "numpy", "scipy", "scikit-fem", "gmsh"} == set(record["versions"])


def test_building_twice_gives_the_same_bytes(folder: Path) -> None:
    before = (folder / "squares.npz").read_bytes()
    build(EXAMPLE, folder)
    assert (folder / "squares.npz").read_bytes() == before


def test_truncated_and_altered_files_are_refused_by_name(folder: Path) -> None:
    numbers = folder / "squares.npz"
    content = numbers.read_bytes()
    numbers.write_bytes(content[:-10])
    with pytest.raises(DamagedReferenceError, match=r"squares\.npz: truncated"):
        load("squares", folder)
    numbers.write_bytes(content[:50] + bytes([content[50] ^ 1]) + content[51:])
    with pytest.raises(DamagedReferenceError, match=r"squares\.npz: altered"):
        load("squares", folder)
    numbers.unlink()
    with pytest.raises(DamagedReferenceError, match=r"squares\.npz: the file is missing"):
        load("squares", folder)


def test_altered_records_are_refused_by_name(folder: Path) -> None:
    about = folder / "squares.json"
    text = about.read_text()
    about.write_text(text.replace("nobody", "somebody"))
    with pytest.raises(DamagedReferenceError, match=r"squares\.json: the record was altered"):
        load("squares", folder)
    about.write_text(text[: len(text) // 2])
    with pytest.raises(DamagedReferenceError, match=r"squares\.json: not a complete record"):
        load("squares", folder)
    about.write_text(json.dumps({"name": "squares"}))
    with pytest.raises(DamagedReferenceError, match="not a complete record"):
        load("squares", folder)


REQUIRED = [
    "name", "title", "citation", "generator", "arguments", "versions", "element_order", "meshes",
    "estimated_error", "bytes", "sha256", "record_sha256",
]  # fmt: skip


def rewrite(folder: Path, **changes: object) -> None:
    """Change a record and sign it again; None takes an entry out."""
    about = folder / "squares.json"
    record = {**json.loads(about.read_text()), **changes}
    record = {k: v for k, v in record.items() if v is not None}
    if "record_sha256" in record:
        record["record_sha256"] = provenance._record_hash(record)
    about.write_text(json.dumps(record))


@pytest.mark.parametrize("key", REQUIRED)
def test_incomplete_records_are_refused_though_their_hash_is_right(folder: Path, key: str) -> None:
    rewrite(folder)
    load("squares", folder)
    rewrite(folder, **{key: None})
    with pytest.raises(DamagedReferenceError, match=rf"not a complete record \('{key}'\)"):
        load("squares", folder)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"citation": ""}, "citation is empty"),
        ({"meshes": []}, "meshes and element order"),
        ({"meshes": [{"size": 0.5}]}, "a mesh has no"),
        ({"meshes": "one"}, "meshes is not"),
        ({"name": "cubes"}, "that of cubes"),
        ({"estimated_error": {"n": 0.0}}, "estimated errors of n for arrays n, squares"),
        ({"estimated_error": {"n": 0.0, "squares": "small"}}, "estimated error is no number"),
    ],
)
def test_records_that_say_nothing_are_refused(folder: Path, change: dict, why: str) -> None:
    rewrite(folder, **change)
    with pytest.raises(DamagedReferenceError, match=f"not a complete record.*{why}"):
        load("squares", folder)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"citation": "somebody (2020)"}, "citation"),
        ({"title": "Cubes"}, "title"),
        ({"arguments": {"numbers": [1, 2, 4]}}, "arguments"),
        ({"generator": catalogue}, "generator"),
    ],
)
def test_a_changed_entry_of_the_catalogue_is_seen(folder: Path, change: dict, what: str) -> None:
    stored = load("squares", folder)
    compare_with_catalogue(EXAMPLE, stored)
    with pytest.raises(DamagedReferenceError, match=f"another {what} than the catalogue has"):
        compare_with_catalogue(replace(EXAMPLE, **change), stored)


def without_meshes(factor: float = 1.0) -> Generated:
    return Generated({"n": factor * np.ones(2)}, {"n": 1e-2})


def test_references_without_meshes_must_agree_to_rounding(tmp_path: Path) -> None:
    """No mesh recorded is not "another mesh": the estimated error allows nothing."""
    plain = Reference("plain", "Plain", "nobody (2020)", without_meshes, {})
    stored = build(plain, tmp_path)
    assert regenerate_and_compare(plain, stored) == 0.0
    off = replace(plain, arguments={"factor": 1.001})
    with pytest.raises(DamagedReferenceError, match="regenerates with a difference"):
        regenerate_and_compare(off, stored)


def test_meshes_on_one_side_only_are_refused(folder: Path, tmp_path: Path) -> None:
    stored = load("squares", folder)
    stored.record["meshes"].clear()
    with pytest.raises(DamagedReferenceError, match="0 meshes recorded, 1 used"):
        regenerate_and_compare(EXAMPLE, stored)


def test_regenerating_a_part_finds_its_rows(folder: Path) -> None:
    assert regenerate_and_compare(EXAMPLE, load("squares", folder)) == 0.0


def test_arrays_on_one_side_only_are_refused(folder: Path) -> None:
    stored, whole = load("squares", folder), replace(EXAMPLE, spot={})
    more = replace(stored, arrays={**stored.arrays, "cubes": np.ones(3)})
    with pytest.raises(DamagedReferenceError, match="no array 'cubes' is made any more"):
        regenerate_and_compare(whole, more)
    fewer = replace(stored, arrays={name: stored.arrays[name] for name in [EXAMPLE.axis or ""]})
    with pytest.raises(DamagedReferenceError, match="the stored file has no array"):
        regenerate_and_compare(EXAMPLE, fewer)


def test_one_per_cent_is_seen(folder: Path) -> None:
    off = Reference(
        "squares", "", "", squares, {"numbers": [1, 2, 3], "factor": 1.01}, EXAMPLE.spot, "n"
    )
    with pytest.raises(DamagedReferenceError, match="regenerates with a difference"):
        regenerate_and_compare(off, load("squares", folder))


def test_another_mesh_may_differ_by_the_estimated_error(
    folder: Path,
) -> None:
    slightly = Reference(
        "squares", "", "", squares, {"numbers": [1, 2, 3], "factor": 1.001}, EXAMPLE.spot, "n"
    )
    with pytest.raises(DamagedReferenceError):
        regenerate_and_compare(slightly, load("squares", folder))
    stored = load("squares", folder)
    stored.record["meshes"][0]["sha256"] = "another"
    assert regenerate_and_compare(slightly, stored) == pytest.approx(1e-3, rel=1e-6)


def test_a_generator_must_say_how_exact_it_is() -> None:
    with pytest.raises(ValueError, match="estimated error"):
        Generated({"a": np.ones(2)}, {})
    with pytest.raises(ValueError, match="not negative"):
        Generated({"a": np.ones(2)}, {"a": np.nan})
    with pytest.raises(ValueError, match="both or none"):
        Generated({"a": np.ones(2)}, {"a": 0.0}, order=2)
    with pytest.raises(ValueError, match="not finite"):
        Generated({"a": np.array([np.nan])}, {"a": 0.0})


@pytest.mark.parametrize("name", list(catalogue()))
def test_every_stored_reference_is_whole(name: str) -> None:
    reference, stored = catalogue()[name], load(name)
    compare_with_catalogue(reference, stored)
    # all of them contain finite-element numbers, but for one closed form
    assert bool(stored.record["meshes"]) == (name != "lamb-pulse")
    assert stored.record["element_order"] == (None if name == "lamb-pulse" else 2)
    assert max(stored.record["estimated_error"].values()) < 2e-3


def test_errors_of_the_tetrachiral_tables_are_their_own() -> None:
    free, clamped = load("tetrachiral-free"), load("tetrachiral-clamped")
    # exact lattices: what errs is the eigensolver
    assert 0 < free.error("lattice") < 1e-9
    assert 0 < clamped.error("lattice") < 1e-9
    assert clamped.error("continuum_n") != clamped.error("continuum_n_minus_1")
    shapes = {key for mesh in free.record["meshes"] for key in mesh}
    assert {"triangles", "quadrilaterals"} <= shapes


@pytest.mark.slow
@pytest.mark.parametrize("name", list(catalogue()))
def test_every_stored_reference_can_be_made_again(name: str) -> None:
    assert regenerate_and_compare(catalogue()[name], load(name)) < 2e-3


def test_the_data_stay_small_and_belong_to_the_catalogue() -> None:
    files = [p for p in DATA.iterdir() if p.suffix in (".npz", ".json")]
    assert sum(p.stat().st_size for p in files) < 5e6
    assert {p.stem for p in files} == set(catalogue())


def test_command_line(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    runner = CliRunner()
    monkeypatch.setattr("references.__main__.catalogue", lambda: {"squares": EXAMPLE})
    monkeypatch.setattr("references.__main__.DATA", folder)
    for module in ("references.__main__.load", "references.__main__.build"):
        function = getattr(provenance, module.rsplit(".", 1)[1])
        monkeypatch.setattr(module, lambda what, function=function: function(what, folder))
    listed = runner.invoke(app, ["list"])
    assert listed.exit_code == 0
    assert "squares" in listed.output
    assert runner.invoke(app, ["check"]).exit_code == 0
    (folder / "squares.npz").write_bytes(b"")
    broken = runner.invoke(app, ["check"])
    assert broken.exit_code == 1
    assert "truncated" in broken.output
    assert runner.invoke(app, ["build", "squares"]).exit_code == 0
    assert runner.invoke(app, ["check"]).exit_code == 0
    changed = {"squares": replace(EXAMPLE, citation="somebody else")}
    with monkeypatch.context() as patch:
        patch.setattr("references.__main__.catalogue", lambda: changed)
        other = runner.invoke(app, ["check"])
        assert other.exit_code == 1
        assert "another citation" in " ".join(other.output.split())
    (folder / "stray.npz").write_bytes(b"")
    assert runner.invoke(app, ["check"]).exit_code == 1
    assert runner.invoke(app, ["check", "nothing"]).exit_code == 2
