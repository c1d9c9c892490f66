"""Bodies with the same moments, and their free rotation."""
from __future__ import annotations

import ctypes as c
import operator
import weakref
from typing import Any, Optional

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import read, same_length, state, written
from ._library import Status, check, check_bodies, library, sentence_of_status


def _destroy(handle: c.c_void_p) -> None:
    library.poinsot_body_destroy(c.byref(handle))


class Body:
    """A rigid body, given by its principal moments of inertia.

    >>> book = Body([0.376, 0.627, 1.0])
    >>> y, q = np.array([0.0, 0.6, -0.8]), np.array([1.0, 0.0, 0.0, 0.0])
    >>> y, q = book.rotate(y, q, 40.0)
    >>> y.round(8)
    array([ 0.05459368, -0.59303071, -0.8033269 ])

    Parameters
    ----------
    moments : array_like, shape (3,)
        Zero or positive, in any order and unit, the largest at most the sum of the others.

    Attributes
    ----------
    moments : numpy.ndarray, shape (3,)
        About the axes that y and q refer to.
    axes : numpy.ndarray, shape (3, 3)
        These axes as columns, in the frame that the body was given in: the identity, except after `from_tensor` and `from_points`.
    centre : numpy.ndarray, shape (3,)
        The centre of mass in that frame: zero, except after `from_points`.
    mass : float or None
        The total mass, after `from_points`.
    """

    moments: np.ndarray
    axes: np.ndarray
    centre: np.ndarray
    mass: Optional[float] = None

    def __init__(self, moments: ArrayLike) -> None:
        given = read("moments", moments, (3,)).copy()
        handle = c.c_void_p()
        status = library.poinsot_body_create(given.ctypes.data, c.byref(handle))
        check(status, sentence_of_status(library.poinsot_moments_check, given.ctypes.data) if status else "")
        self._take(handle, ("__init__", given), given, np.eye(3), np.zeros(3))

    @classmethod
    def from_tensor(cls, tensor: ArrayLike) -> Body:
        """A body from its inertia tensor, symmetric, shape (3, 3), in any frame.

        y and q of the body refer to its principal axes, the columns of `axes`: x_given = axes @ x_principal.
        """
        given = read("tensor", tensor, (3, 3)).copy()
        return cls._from_tensor(given, np.zeros(3), ("from_tensor", given))

    @classmethod
    def from_points(cls, mass: ArrayLike, x: ArrayLike) -> Body:
        """A body of n point masses, zero or positive, shape (n,), at x, shape (n, 3), in any frame.

        y and q of the body refer to its principal axes through the centre of mass: x = centre + axes @ x_principal.

        >>> water = Body.from_points([15.999, 1.008, 1.008], [[0, 0, 0], [0.757, 0.586, 0], [-0.757, 0.586, 0]])
        >>> water.moments.round(3)
        array([0.615, 1.155, 1.77 ])
        """
        points = np.asarray(x)
        masses = read("mass", mass, points.shape[:1])
        points = read("x", points, (len(masses), 3))
        if not len(masses):
            raise ValueError("a body needs at least one point")
        centre, tensor = np.empty(3), np.empty((3, 3))
        status = library.poinsot_inertia_of_points(len(masses), masses.ctypes.data, points.ctypes.data, centre.ctypes.data,
                                                   tensor.ctypes.data)
        check(status, "masses must be finite, zero or positive and not all zero, and points finite; centre of mass and tensor "
                      "must be within the range of numbers" if status == Status.DOMAIN else "")
        body = cls._from_tensor(tensor, centre, ("from_points", masses.copy(), points.copy()))
        body.mass = float(masses.sum())
        return body

    @classmethod
    def _from_tensor(cls, tensor: np.ndarray, centre: np.ndarray, made: tuple[Any, ...]) -> Body:
        handle, axes, moments = c.c_void_p(), np.empty((3, 3)), np.empty(3)
        status = library.poinsot_body_create_tensor(tensor.ctypes.data, c.byref(handle), axes.ctypes.data)
        check(status, sentence_of_status(library.poinsot_inertia_check, tensor.ctypes.data) if status else "")
        library.poinsot_principal_axes(tensor.ctypes.data, moments.ctypes.data, axes.ctypes.data)  # the same axes
        body = cls.__new__(cls)
        body._take(handle, made, moments, axes, centre)
        return body

    def _take(self, handle: c.c_void_p, made: tuple[Any, ...], moments: np.ndarray, axes: np.ndarray, centre: np.ndarray) -> None:
        self._handle, self._made = handle, made
        self.moments, self.axes, self.centre = moments, axes, centre
        moments.flags.writeable = axes.flags.writeable = centre.flags.writeable = False
        self._finalizer = weakref.finalize(self, _destroy, handle)

    def __reduce__(self) -> Any:  # copies and pickles are made anew: a handle belongs to one object
        how, *values = self._made
        return (type(self) if how == "__init__" else getattr(type(self), how)), tuple(values)

    def __repr__(self) -> str:
        return f"Body({self.moments.tolist()})"

    def rotate(self, y: np.ndarray, q: np.ndarray, h: float, steps: int = 1, method: str = "exact", *,
               status: Optional[np.ndarray] = None) -> tuple[np.ndarray, np.ndarray]:
        """Advance n such bodies by free rotation, in place: `steps` steps of size `h`.

        Parameters
        ----------
        y : numpy.ndarray of float64, shape (3,) or (n, 3)
            Angular momenta in the body frame.
        q : numpy.ndarray of float64, shape (4,) or (n, 4)
            Attitudes: unit quaternions, scalar first, body to space.
        h : float
            Step size, of either sign.
        steps : int
            Number of steps.
        method : str
            One of poinsot.methods().
        status : numpy.ndarray of int32, shape (n,), optional
            Receives the status of each body; bodies that fail then raise no exception.

        Returns
        -------
        (y, q)
            The same two arrays. Arrays that are not contiguous are copied, and the result is copied back.

        Raises
        ------
        poinsot.Error
            If the call failed, or some bodies did (Status.PARTIAL). Those keep their states.
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
