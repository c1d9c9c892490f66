"""Elliptic functions of arrays, in the library's accuracy: 1e-15 for every modulus.

Arguments are broadcast against each other; numbers give numbers. An element out of its domain is NaN in the arrays, and the
call raises poinsot.Error, whose `result` has them: the other elements are right.
"""
from __future__ import annotations

from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike

from ._library import Error, library

__all__ = ["jacobi"]


def jacobi(u: ArrayLike, m: ArrayLike, m1: Optional[ArrayLike] = None) -> tuple[Any, Any, Any]:
    """sn, cn and dn of u, |u| <= 1e15, with the parameter m = k^2 from 0 to 1; m1 = 1 - m, for who knows it better than 1 - m."""
    given = np.broadcast_arrays(*(np.asarray(a, dtype=np.float64) for a in ((u, m) if m1 is None else (u, m, m1))))
    shape = given[0].shape
    arguments = [np.ascontiguousarray(a) for a in given]
    values = tuple(np.empty(shape) for _ in range(3))
    addresses = [a.ctypes.data for a in arguments] + ([None] if m1 is None else [])
    status = library.poinsot_jacobi(values[0].size, *addresses, *(a.ctypes.data for a in values))
    result = tuple(a[()] for a in values)
    if status:
        first = np.argmax(np.isnan(values[0]))
        raise Error(status, f"element {first} is out of the domain: u = {arguments[0].flat[first]}, m = {arguments[1].flat[first]}; "
                            "|u| is at most 1e15, and m from 0 to 1", result=result)
    return result[0], result[1], result[2]
