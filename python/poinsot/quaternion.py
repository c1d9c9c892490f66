"""Quaternions in arrays of shape (..., 4), scalar first, by Hamilton's product.

A unit quaternion is an attitude, body to space; q and -q are the same. Where an attitude is read it must be of unit norm to
1e-6; results that are attitudes are of unit norm. Vectors have the shape (..., 3), rotation matrices (..., 3, 3), with the
body's axes in space as columns; angles are in radians. Axes in front are broadcast against each other. An element without an
answer is NaN in the arrays, and the call raises poinsot.Error, whose `result` has them: the other elements are right.

>>> q = from_axis_angle([0, 0, 1], np.pi/2)
>>> rotate(q, [1, 0, 0]).round(15)
array([0., 1., 0.])
"""
from __future__ import annotations

import operator
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike

from ._elementwise import MATRIX, NUMBER, QUATERNION, VECTOR, Shape, evaluate
from ._library import Error, Status, check, library

__all__ = ["conjugate", "distance", "exp", "from_axis_angle", "from_cayley", "from_euler", "from_matrix", "from_rotation_vector",
           "inverse", "log", "multiply", "nearest", "normalize", "random", "rotate", "rotate_back", "shortest_arc", "slerp",
           "to_axis_angle", "to_cayley", "to_euler", "to_matrix", "to_rotation_vector"]

_unit = "q must be a unit quaternion, to 1e-6"
_finite = "all components must be finite, and those of the result within the range of numbers"
_conventions = ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz")


def multiply(p: ArrayLike, q: ArrayLike) -> np.ndarray:
    """The product p o q; of attitudes: first q, then p."""
    return _call("multiply", {"p": (p, QUATERNION), "q": (q, QUATERNION)}, QUATERNION, _finite)


def conjugate(q: ArrayLike) -> np.ndarray:
    """The conjugate, with the sign of the vector part changed; of an attitude, the inverse rotation."""
    return _of_quaternions("conjugate", q, _finite)


def inverse(q: ArrayLike) -> np.ndarray:
    """1/q, of any quaternion but zero."""
    return _of_quaternions("inverse", q, "q must not be zero; " + _finite)


def normalize(q: ArrayLike) -> np.ndarray:
    """q/|q|, of any quaternion but zero."""
    return _of_quaternions("normalize", q, "q must be finite and not zero")


def exp(q: ArrayLike) -> np.ndarray:
    """The exponential; exp((0, v)) is the rotation by 2 |v| about v."""
    return _of_quaternions("exp", q, "the scalar part is at most 709.78, and all must be finite")


def log(q: ArrayLike) -> np.ndarray:
    """The principal logarithm: the length of its vector part is at most pi; of a negative real number it lies along the first axis."""
    return _of_quaternions("log", q, "q must be finite and not zero")


def rotate(q: ArrayLike, v: ArrayLike) -> np.ndarray:
    """Q v: a body-frame vector in the space frame."""
    return _call("rotate", {"q": (q, QUATERNION), "v": (v, VECTOR)}, VECTOR, _unit + ", v finite")


def rotate_back(q: ArrayLike, v: ArrayLike) -> np.ndarray:
    """Q^T v: a space-frame vector in the body frame."""
    return _call("rotate_back", {"q": (q, QUATERNION), "v": (v, VECTOR)}, VECTOR, _unit + ", v finite")


def to_matrix(q: ArrayLike) -> np.ndarray:
    """The rotation matrix."""
    return _from_attitude("to_matrix", q, MATRIX)


def from_matrix(m: ArrayLike) -> np.ndarray:
    """The attitude of a rotation matrix, which must be one to 4e-6; its scalar part is not negative."""
    return _call("from_matrix", {"m": (m, MATRIX)}, QUATERNION,
                           "m must be a rotation, to 4e-6, with determinant +1; `nearest` takes others")


def nearest(m: ArrayLike) -> np.ndarray:
    """The rotation nearest to a matrix in the least-squares sense, if it is unique; its scalar part is not negative."""
    return _call("nearest", {"m": (m, MATRIX)}, QUATERNION, "m has no nearest rotation, or several")


def from_rotation_vector(v: ArrayLike) -> np.ndarray:
    """The attitude of the rotation by |v| about v."""
    return _call("from_rotation_vector", {"v": (v, VECTOR)}, QUATERNION, "v must be finite")


def to_rotation_vector(q: ArrayLike) -> np.ndarray:
    """Angle times axis, of length at most pi."""
    return _from_attitude("to_rotation_vector", q, VECTOR)


def from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> np.ndarray:
    """The attitude of the rotation by an angle about an axis of any non-zero length."""
    return _call("from_axis_angle", {"axis": (axis, VECTOR), "angle": (angle, NUMBER)}, QUATERNION,
                           "the axis must be finite and not zero, and the angle finite")


def to_axis_angle(q: ArrayLike) -> tuple[np.ndarray, Any]:
    """Unit axis and angle, from 0 to pi; the axis of the identity is the first."""
    values: tuple[np.ndarray, Any] = evaluate("quaternion_to_axis_angle", {"q": (q, QUATERNION)}, (VECTOR, NUMBER), _unit)
    return values


def from_cayley(e: ArrayLike) -> np.ndarray:
    """The attitude of a Cayley vector, tan(angle/2) times axis."""
    return _call("from_cayley", {"e": (e, VECTOR)}, QUATERNION, "e must be finite")


def to_cayley(q: ArrayLike) -> np.ndarray:
    """The Cayley vector tan(angle/2) times axis; undefined for a half-turn."""
    return _from_attitude("to_cayley", q, VECTOR, "; a half-turn has no Cayley vector")


def from_euler(convention: str, angles: ArrayLike) -> np.ndarray:
    """The attitude of intrinsic Euler angles, q = q_1(a1) o q_2(a2) o q_3(a3), about the axes that `convention` names.

    "xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"
    """
    return _call("from_euler", {"angles": (angles, VECTOR)}, QUATERNION, "angles must be finite",
                           _convention(convention))


def to_euler(convention: str, q: ArrayLike) -> np.ndarray:
    """Euler angles as of `from_euler`: the first and the third from -pi to pi, the second from 0 to pi if the first and the third
    axis are the same, else from -pi/2 to pi/2. In gimbal lock the third is 0."""
    return _call("to_euler", {"q": (q, QUATERNION)}, VECTOR, _unit, _convention(convention))


def slerp(p: ArrayLike, q: ArrayLike, t: ArrayLike) -> np.ndarray:
    """Spherical interpolation from p (t = 0) to q (t = 1) by the shorter arc; extrapolates outside [0, 1]."""
    return _call("slerp", {"p": (p, QUATERNION), "q": (q, QUATERNION), "t": (t, NUMBER)}, QUATERNION,
                           "p and q must be unit quaternions, to 1e-6, and t finite")


def shortest_arc(a: ArrayLike, b: ArrayLike) -> np.ndarray:
    """The smallest rotation that takes direction a to direction b; its scalar part is not negative."""
    return _call("shortest_arc", {"a": (a, VECTOR), "b": (b, VECTOR)}, QUATERNION,
                           "a and b must be finite and not zero")


def distance(p: ArrayLike, q: ArrayLike) -> Any:
    """min(|p - q|, |p + q|), of any two quaternions; for attitudes, half the angle between them if that is small."""
    return evaluate("quaternion_distance", {"p": (p, QUATERNION), "q": (q, QUATERNION)}, (NUMBER,), _finite)


def random(n: Union[int, tuple[int, ...]], seed: int) -> np.ndarray:
    """Uniformly distributed attitudes, n of them or an array of that shape: number i is a function of seed and i."""
    shape = tuple(operator.index(k) for k in (n if isinstance(n, tuple) else (n,)))
    number = operator.index(seed)
    if min(shape, default=0) < 0:
        raise ValueError(f"n = {n} must not be negative")
    if not -2**63 <= number < 2**63:
        raise ValueError(f"seed = {seed} must be an integer of 64 bits")
    q = np.empty(shape + QUATERNION)
    check(library.poinsot_quaternion_random(q.size//4, number, q.ctypes.data))
    return q


def _call(name: str, given: dict[str, tuple[Any, Shape]], result: Shape, domain: str, *options: Any) -> np.ndarray:
    values: np.ndarray = evaluate("quaternion_" + name, given, (result,), domain, *options)
    return values


def _of_quaternions(name: str, q: ArrayLike, domain: str) -> np.ndarray:
    return _call(name, {"q": (q, QUATERNION)}, QUATERNION, domain)


def _from_attitude(name: str, q: ArrayLike, shape: Shape, more: str = "") -> np.ndarray:
    return _call(name, {"q": (q, QUATERNION)}, shape, _unit + more)


def _convention(name: str) -> bytes:
    if name not in _conventions:
        raise Error(Status.METHOD, f"unknown convention of Euler angles {name!r}; allowed are {', '.join(_conventions)}")
    return name.encode()
