"""One thread within the context, what it was before after it."""

import numpy as np
import scipy.linalg  # noqa: F401
from threadpoolctl import threadpool_info, threadpool_limits

from solver.blas import one_thread


def threads():
    return [lib["num_threads"] for lib in threadpool_info() if lib["user_api"] == "blas"]


def test_blas_keeps_to_one_thread_and_gets_back_what_it_had():
    np.ones(2) @ np.ones(2)
    with threadpool_limits(limits=2, user_api="blas"):
        before = threads()
        assert before
        for _ in range(2):
            with one_thread():
                assert set(threads()) == {1}
            assert threads() == before
