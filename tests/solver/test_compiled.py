"""Kernels are kept where that is possible, done without where not, and never kept stale."""

import subprocess
import sys

import numba as nb
import pytest

from solver import compiled
from solver.fracture import bond_kernels
from solver.material import strains


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
    kept = bond_kernels.bond_energies._cache._cache_file._source_stamp
    assert len(kept) == 2
    assert strains.__file__.endswith("strains.py")
