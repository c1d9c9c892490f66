"""Functions of arrays, element by element: what poinsot.elliptic and poinsot.quaternion have in common."""
from __future__ import annotations

from math import prod
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import real
from ._library import Error, Status, library, status_text

Shape = tuple[int, ...]

NUMBER: Shape = ()
VECTOR: Shape = (3,)
QUATERNION: Shape = (4,)
MATRIX: Shape = (3, 3)


def evaluate(function: str, given: dict[str, tuple[Optional[ArrayLike], Shape]], results: tuple[Shape, ...],
             domain: str, *options: Any) -> Any:
    """Call a function of the library on arrays: `given` are its arguments with the shape of one element, then its results.

    The axes in front of the elements' own are broadcast against each other. An argument that is None is passed as NULL. One
    result comes as an array, several as a tuple, single numbers as floats.
    """
    arrays = {name: real(name, value) for name, (value, _) in given.items() if value is not None}
    for name, array in arrays.items():
        element = given[name][1]
        if array.shape[array.ndim - len(element):] != element or array.ndim < len(element):
            raise ValueError(f"{name} must have the shape (..., {', '.join(map(str, element))}), not {array.shape}")
    outer = _outer({name: array.shape[:array.ndim - len(given[name][1])] for name, array in arrays.items()})
    arrays = {name: np.asarray(np.broadcast_to(array, outer + given[name][1]), order="C") for name, array in arrays.items()}
    values = [np.empty(outer + element) for element in results]
    addresses = [arrays[name].ctypes.data if name in arrays else None for name in given]
    status = getattr(library, "poinsot_" + function)(prod(outer), *options, *addresses, *(a.ctypes.data for a in values))
    answer = values[0][()] if len(values) == 1 else tuple(a[()] for a in values)
    if status:
        raise Error(status, _sentence(status, outer, values, {n: (a, given[n][1]) for n, a in arrays.items()}, domain),
                    result=answer)
    return answer


def _outer(shapes: dict[str, Shape]) -> Shape:
    """The common shape of the axes in front."""
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        raise ValueError("the shapes cannot be broadcast: "
                         + ", ".join(f"{shape} of {name}" for name, shape in shapes.items())) from None


def _sentence(status: int, outer: Shape, values: list[np.ndarray], arrays: dict[str, tuple[np.ndarray, Shape]],
              domain: str) -> str:
    """Which element is the first without an answer, what was given there, and what is allowed."""
    failed = np.zeros(prod(outer), bool)
    for value in values:
        failed |= np.isnan(value.reshape(prod(outer), -1)).any(axis=1)
    if status != Status.DOMAIN or not failed.any():
        return status_text(status)
    first = int(np.argmax(failed))
    place = np.unravel_index(first, outer)
    number = ", ".join(map(str, place))
    who = "" if not outer else f"element {number if len(outer) == 1 else '(' + number + ')'}: "
    what = ", ".join(f"{name} = {array[place].tolist()}" for name, (array, _) in arrays.items())
    others = int(failed.sum()) - 1
    more = f" ({others} more without an answer)" if others else ""
    return f"{who}{what} is out of the domain: {domain}{more}"
