"""One kind of body, and its free rotation."""
from __future__ import annotations

import ctypes as c
import operator
import weakref
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import read, same_length, state, written
from ._library import Status, check, check_bodies, library


def _destroy(handle: c.c_void_p) -> None:
    library.poinsot_body_destroy(c.byref(handle))


class Body:
    """A kind of body, from its principal moments of inertia.

    >>> book = Body([0.376, 0.627, 1.0])
    >>> y, q = np.array([0.0, 0.6, -0.8]), np.array([1.0, 0.0, 0.0, 0.0])
    >>> y, q = book.rotate(y, q, 40.0)
    >>> y.round(12)
    array([ 0.054593680517, -0.593030709319, -0.803326899744])

    Parameters
    ----------
    moments : array_like, shape (3,)
        Zero or positive, in any order and unit, the largest at most the sum of the others.

    Attributes
    ----------
    moments : numpy.ndarray, shape (3,)
        About the axes that y and q refer to.
    axes : numpy.ndarray, shape (3, 3)
        These axes as columns, in the frame that the body was given in: the identity, but for `from_tensor` and `from_points`.
    """

    moments: np.ndarray
    axes: np.ndarray

    def __init__(self, moments: ArrayLike) -> None:
        given = read("moments", moments, (3,))
        handle = c.c_void_p()
        check(library.poinsot_body_create(given.ctypes.data, c.byref(handle)))
        self._take(handle, ("__init__", given.copy()), given.copy(), np.eye(3))

    @classmethod
    def from_tensor(cls, tensor: ArrayLike) -> Body:
        """A body from its inertia tensor, symmetric, shape (3, 3), in any frame.

        y and q of the body refer to its principal axes, the columns of `axes`: x_given = axes @ x_principal.
        """
        given = read("tensor", tensor, (3, 3))
        handle, axes = c.c_void_p(), np.empty((3, 3))
        check(library.poinsot_body_create_tensor(given.ctypes.data, c.byref(handle), axes.ctypes.data))
        moments = np.einsum("ij,ik,kj->j", axes, (given + given.T)/2, axes)
        body = cls.__new__(cls)
        body._take(handle, ("from_tensor", given.copy()), moments, axes)
        return body

    def _take(self, handle: c.c_void_p, made: tuple[str, Any], moments: np.ndarray, axes: np.ndarray) -> None:
        self._handle, self._made = handle, made
        self.moments, self.axes = moments, axes
        moments.flags.writeable = axes.flags.writeable = False
        self._finalizer = weakref.finalize(self, _destroy, handle)

    def __reduce__(self) -> Any:  # copies and pickles are made anew: a handle belongs to one object
        how, values = self._made
        return (type(self) if how == "__init__" else getattr(type(self), how)), (values,)

    def __repr__(self) -> str:
        return f"Body({self.moments.tolist()})"

    def rotate(self, y: np.ndarray, q: np.ndarray, h: float, steps: int = 1, method: str = "exact", *,
               status: Optional[np.ndarray] = None) -> tuple[np.ndarray, np.ndarray]:
        """Turn n bodies of this kind freely, in place: `steps` steps of length `h`.

        Parameters
        ----------
        y : numpy.ndarray of float64, shape (3,) or (n, 3)
            Angular momenta in the body frame.
        q : numpy.ndarray of float64, shape (4,) or (n, 4)
            Attitudes: unit quaternions, scalar first, body to space.
        h : float
            Length of a step, of either sign.
        steps : int
            How many.
        method : str
            One of poinsot.methods().
        status : numpy.ndarray of int32, shape (n,), optional
            Receives the status of each body; bodies that fail then raise no exception.

        Returns
        -------
        (y, q)
            The same two arrays. Arrays that are not contiguous are worked on in a copy, which is brought back.

        Raises
        ------
        poinsot.Error
            If the call, or some bodies (Status.PARTIAL), failed. These have kept their states.
        """
        momenta, attitudes = state(y, q, contiguous=True)
        n = same_length(momenta, attitudes)
        count = operator.index(steps)
        if count < 0:
            raise ValueError(f"steps = {count} must not be negative")
        each = np.zeros(n, np.int32) if status is None else written("status", status, (n,), np.int32)
        answer = library.poinsot_rotate(self._handle, method.encode(), h, count, n, momenta.component(0),
                                        attitudes.component(0), each.ctypes.data)
        momenta.finish()
        attitudes.finish()
        message = f"there is no method '{method}'; poinsot.methods() lists them" if answer == Status.METHOD else ""
        check_bodies(answer, each, status is not None, message)
        return y, q
