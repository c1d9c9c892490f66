"""Arrays at the border: what the library changes in place is float64 and the caller's own; what it only reads may be anything."""
from __future__ import annotations

from typing import Any, Optional

import numpy as np


class InPlace:
    """A caller's array of shape (k,) or (n, k) that a call changes in place.

    The library gets the caller's memory. Where it cannot (a view whose rows run backwards, or are not contiguous where they
    must be) it gets a copy, and `finish` brings the result back. An array of another type is refused: what it would receive
    is not what was computed.
    """

    def __init__(self, name: str, array: np.ndarray, k: int, contiguous: bool = False) -> None:
        if not isinstance(array, np.ndarray):
            raise TypeError(f"{name} is changed in place and must be a NumPy array of float64, not {type(array).__name__}: "
                            f"numpy.array({name}, dtype=float) makes one")
        if array.dtype != np.float64:
            raise TypeError(f"{name} is changed in place and must be float64, not {array.dtype}: "
                            f"{name}.astype(float) makes an array that can be")
        if array.ndim not in (1, 2) or array.shape[-1] != k:
            raise ValueError(f"{name} must have the shape ({k},) or (n, {k}), not {array.shape}")
        if not array.flags.writeable:
            raise ValueError(f"{name} is changed in place, but the array is read-only")
        self.single = array.ndim == 1
        self.rows = array[np.newaxis] if self.single else array
        self.work = self.rows
        aligned = array.flags.aligned and all(s % 8 == 0 for s in array.strides)
        fits = array.flags.c_contiguous if contiguous else len(self.rows) == 1 or self.rows.strides[0] >= 8
        if not (aligned and fits):
            self.work = np.ascontiguousarray(self.rows).copy()

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def stride(self) -> int:
        """From one row to the next, in doubles."""
        return int(self.work.strides[0]//8) if len(self.work) > 1 else self.work.shape[1]

    def component(self, j: int) -> Optional[int]:
        """Address of component j of the first row."""
        return self.work.ctypes.data + j*self.work.strides[1] if len(self.work) else None

    def finish(self) -> None:
        """Bring the result back, if the call worked on a copy."""
        if self.work is not self.rows:
            self.rows[...] = self.work


def state(y: np.ndarray, q: np.ndarray, momenta: int = 3, contiguous: bool = False) -> tuple[InPlace, InPlace]:
    """Momenta and attitudes, checked against each other."""
    first, second = InPlace("y", y, momenta, contiguous), InPlace("q", q, 4, contiguous)
    if first.single != second.single:
        raise ValueError(f"y of shape {y.shape} and q of shape {q.shape}: one has one body, the other several")
    if np.may_share_memory(y, q) and np.shares_memory(y, q):
        raise ValueError("y and q overlap in memory")
    return first, second


def same_length(y: InPlace, q: InPlace) -> int:
    """How many bodies."""
    if len(y) != len(q):
        raise ValueError(f"y has {len(y)} rows and q has {len(q)}: they must have one row per body")
    return len(y)


def read(name: str, values: Any, shape: tuple[int, ...], dtype: Any = np.float64) -> np.ndarray:
    """What the library only reads: any array-like of this shape, copied if it is not of this type and contiguous."""
    array = np.asarray(values)
    if np.issubdtype(dtype, np.integer) and array.size and not np.issubdtype(array.dtype, np.integer):
        raise TypeError(f"{name} must be integers, not {array.dtype}")
    if array.shape != shape:
        raise ValueError(f"{name} must have the shape {shape}, not {array.shape}")
    if np.issubdtype(dtype, np.integer) and array.size:
        limits = np.iinfo(dtype)
        if array.min() < limits.min or array.max() > limits.max:
            raise ValueError(f"{name} must be from {limits.min} to {limits.max}")
    return np.ascontiguousarray(array if np.issubdtype(dtype, np.integer) else real(name, array), dtype=dtype)


def real(name: str, values: Any) -> np.ndarray:
    """Real numbers of any shape as float64."""
    array = np.asarray(values)
    if np.issubdtype(array.dtype, np.complexfloating):
        raise TypeError(f"{name} must be real, not {array.dtype}")
    return np.asarray(array, dtype=np.float64)


def written(name: str, array: np.ndarray, shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    """What the library writes into and the caller holds: exactly this shape and type, contiguous."""
    if not isinstance(array, np.ndarray) or array.dtype != dtype or array.shape != shape or \
            not array.flags.c_contiguous or not array.flags.writeable:
        given = f"{array.dtype} of shape {array.shape}" if isinstance(array, np.ndarray) else type(array).__name__
        raise TypeError(f"{name} is written into and must be a contiguous array of {np.dtype(dtype)} of shape {shape}, not {given}")
    return array
