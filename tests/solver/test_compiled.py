"""Kernels are kept where that is possible, done without where not, and never kept stale."""

import json
import os
import subprocess
import sys

import numba as nb
import numpy as np
import pytest

from solver import (
    ConductivityTensor,
    Crack,
    ElasticTensor,
    Scene,
    Support,
    compiled,
    fracture,
    rectangle,
)
from solver.analyses.statics import solve
from solver.fracture import bond_kernels
from solver.material import strains

# Prints, one scene after another, the kernels that have been compiled or found on disk by then.
FIRST_USE = """
import gc, json
from numba.core.dispatcher import Dispatcher
from solver import ConductivityTensor, Crack, ElasticTensor, Scene, Support, rectangle
from solver.reactions import reaction

def told(solution):
    found = [d.py_func for d in gc.get_objects() if isinstance(d, Dispatcher) and d.signatures]
    names = [f.__qualname__ for f in found if f.__module__.startswith("solver.")]
    print(json.dumps([solution.statistics.method, sorted(names)]))

plate, spacing = rectangle(2.0, 1.0), 0.1
heat, solid = ConductivityTensor.isotropic(1.0), ElasticTensor.isotropic(10.0, 0.25)
warm = Support.layer(cells=2.5, temperature=lambda x, y: x)
held = Support.layer(cells=2.5, displacement=(0.01, 0.0))
told(Scene(plate, spacing, heat, [warm], m=2).solve())
told(Scene(plate, spacing, solid, [held], m=2).solve())
pulled = Scene(plate, spacing / 2, solid, [held], m=2).solve()
reaction(pulled, lambda x, y: x < -0.8)
told(pulled)
cut = Crack((-0.3, 0.02), (0.3, 0.02))
told(Scene(plate, spacing, solid, [held], m=2, cracks=[cut]).solve())
"""
# What each of them needs beyond those before it.
NEEDED = {
    "heat, small": {"_span", "_mark_near", "scatter", "conductive_product", "block_scale"},
    "elastic, small": {"elastic_product", "_elastic_lanes"},
    "elastic": {"narrow", "relax", "weighted_rows"},
    "crack": {"_rest", "sign_of_cross", "side", "_touches", "_mark_tips", "_mark_lying", "_moved"}
    | {"_beside", "cuts", "_mark_cut", "_lies", "_mark_between"},
}


def double(x):
    return 2 * x


def test_a_kernel_computes():
    assert compiled.kernel()(double)(3) == 6


def test_without_a_place_for_the_cache_it_compiles_in_memory(monkeypatch):
    njit = nb.njit

    def refuses(*arguments, cache=False, **options):
        if cache:
            raise RuntimeError("cannot cache function: no locator available")
        return njit(*arguments, **options)

    monkeypatch.setattr(compiled.nb, "njit", refuses)
    monkeypatch.setattr(compiled, "in_memory", [])
    assert compiled.kernel()(double)(3) == 6
    assert compiled.in_memory == ["double"]


def test_without_a_place_the_whole_solver_is_imported():
    """Every kernel must go through `compiled.kernel`: one that does not stops the import."""
    code = (
        "import numba.core.caching as c; c.CacheImpl._locator_classes = []\n"
        "import solver; from solver.compiled import in_memory; print(len(in_memory))"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(found.stdout) >= 8


def test_a_scene_compiles_only_what_it_uses():
    """Small bodies keep to one thread, so that nothing is compiled for two."""
    found = subprocess.run(
        [sys.executable, "-c", FIRST_USE],
        env=os.environ | {"NUMBA_NUM_THREADS": "2"},
        capture_output=True,
        text=True,
        check=True,
    )
    told = [json.loads(line) for line in found.stdout.splitlines()]
    assert [method for method, _ in told] == [
        "CG, block Jacobi", "CG, block Jacobi", "CG, two-level", "CG, block Jacobi",
    ]  # fmt: skip
    allowed = set()
    for (_, names), (scene, needed) in zip(told, NEEDED.items(), strict=True):
        allowed |= needed
        plain = [name.removesuffix("_alone") for name in names]
        assert set(plain) <= allowed, scene
        assert len(set(plain)) == len(plain), scene
        assert not set(names) & {"scatter", "relax", "elastic_product"}, scene


@pytest.mark.parametrize("kind", ["elastic", "heat", "growing"])
def test_what_is_compiled_for_one_thread_and_for_many_gives_the_same_bits(kind, monkeypatch):
    """Which of the two a body gets depends on its size and on the machine; no answer may."""
    solid, cut = ElasticTensor.isotropic(10.0, 0.25), Crack((-1.5, 0.01), (-0.2, 0.01))
    held = Support.layer(cells=2.5, displacement=lambda x, y: np.stack([0.1 * x, y], -1))
    warm = Support.layer(cells=2.5, temperature=lambda x, y: x * y)

    def answer():
        if kind == "heat":
            body = Scene(
                rectangle(2.0, 1.0), 1 / 20, ConductivityTensor.isotropic(1.0), [warm], m=2
            )
            return solve(body.discretise(), preconditioning="two-level").unknowns
        body = Scene(rectangle(2.0, 1.0), 1 / 20, solid, [held], m=2, cracks=[cut])
        if kind == "elastic":
            return solve(body.discretise(), preconditioning="two-level").unknowns
        run = fracture.grow(body, 1.0, max_solves=4)
        return np.concatenate([run.body.x, run.history.array.ravel()])

    found = []
    for name in ("alone", "shared"):
        monkeypatch.setattr(
            compiled.Threaded,
            "__call__",
            lambda self, *given, name=name: getattr(self, name)(*given),
        )
        found.append(answer())
    np.testing.assert_array_equal(*found)


def test_a_full_disk_does_not_end_a_solve(monkeypatch):
    found = compiled.kernel()(double)

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(found._cache, "_save_overload", full, raising=False)
    monkeypatch.setattr(found._cache._impl.locator, "ensure_cache_path", full)
    assert found(3.5) == 7.0


def test_what_a_kernel_calls_belongs_to_its_stamp(tmp_path):
    source = tmp_path / "called.py"
    source.write_text("a")
    stamps = []
    for text in ("a", "another"):
        source.write_text(text)
        cache = compiled.kernel(uses=(str(source),))(double)._cache
        index = getattr(cache, "_cache_file", None)
        if not hasattr(index, "_source_stamp"):
            pytest.skip("this version of Numba keeps its stamps elsewhere")
        stamps.append(index._source_stamp)
    assert stamps[0] != stamps[1]
    kept = bond_kernels.bond_energies.shared._cache._cache_file._source_stamp
    assert len(kept) == 2
    assert strains.__file__.endswith("strains.py")
