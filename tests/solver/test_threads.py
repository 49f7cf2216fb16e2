"""Small bodies keep to one thread, large ones take what there is; the number is put back."""

import numba as nb
import pytest

from solver import ConductivityTensor, Scene, Support, disc, threads


def _operator(cells: int):
    layer = Support.layer(cells=5.5, temperature=0.0)
    scene = Scene(disc(1.0), 1 / cells, ConductivityTensor.isotropic(1.0), [layer])
    return scene.discretise().operator


def test_threads_grow_with_the_body():
    small = _operator(12)
    assert threads.worth(small) == 1
    large = _operator(150)
    # Twice the work of one thread, or more: bonds of both ends.
    assert threads.worth(large) == large.directed_bonds // 2_000_000 > 1


@pytest.mark.skipif(nb.config.NUMBA_NUM_THREADS < 2, reason="one thread only")
def test_the_number_of_threads_is_put_back_after_errors_too():
    before = nb.get_num_threads()
    operator, seen = _operator(12), []

    def fail() -> None:
        with threads.suited(operator):
            seen.append(nb.get_num_threads())
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    assert seen == [1]
    assert nb.get_num_threads() == before
