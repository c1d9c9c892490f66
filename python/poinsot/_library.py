"""The shared library through ctypes: where it is, its functions, its statuses as exceptions.

A ctypes call releases the GIL. POINSOT_LIBRARY and POINSOT_APP name another library and app than the package's own.
"""
from __future__ import annotations

import ctypes as c
import enum
import os
from pathlib import Path
from typing import Any, Optional

import numpy as np

pointer = c.c_void_p
text = c.c_char_p


class Status(enum.IntEnum):
    """Status of a call or of one body: the POINSOT_E_... of poinsot.h."""

    OK = 0
    NULL = 1
    SIZE = 2
    DOMAIN = 3
    METHOD = 4
    STEP = 5
    CONVERGENCE = 6
    MEMORY = 7
    CALLBACK = 8
    PARTIAL = 9
    IO = 10
    SCENE = 11
    CPU = 12
    NOT_FINITE = 13
    NOT_UNIT = 14
    AXIS_MOMENTUM = 15


class Error(Exception):
    """An error of the library or the app; the text of the exception is its message.

    Attributes
    ----------
    status : Status
        What went wrong.
    each : numpy.ndarray or None
        With Status.PARTIAL, the status of each body. Bodies with status 0 are unaffected; the others keep
        their state from before the call.
    result
        A result that exists nevertheless: values with NaN for the elements without a result, a run whose error is too large.
    """

    def __init__(self, status: int, message: str, each: Optional[np.ndarray] = None, result: Any = None) -> None:
        super().__init__(message)
        self.status = Status(status)
        self.each = each
        self.result = result

    def __reduce__(self) -> Any:
        return type(self), (self.status, str(self), self.each, self.result)


class Bodies(c.Structure):
    """struct poinsot_bodies of poinsot.h."""

    _fields_ = [("size", c.c_size_t), ("n", c.c_size_t), ("y", pointer*3), ("q", pointer*4),
                ("y_stride", c.c_ssize_t), ("q_stride", c.c_ssize_t), ("body_class", pointer), ("id", pointer),
                ("carry", pointer), ("status", pointer), ("y_fourth", pointer), ("first_class", c.c_ssize_t),
                ("class_stride", c.c_ssize_t), ("y_at", pointer), ("q_at", pointer), ("rows", c.c_size_t),
                ("scale", pointer), ("moments", pointer*3), ("moments_stride", c.c_ssize_t)]


#: int torque(context, t, n, q[4], q_stride, torque[3], torque_stride, energy). Addresses come as integers.
TorqueFunction = c.CFUNCTYPE(c.c_int, pointer, c.c_double, c.c_size_t, c.POINTER(c.c_size_t), c.c_ssize_t,
                             c.POINTER(c.c_size_t), c.c_ssize_t, pointer)

_signatures: dict[str, tuple[Any, ...]] = {  # result, then arguments
    "version": (c.c_int,),
    "status_text": (text, c.c_int),
    "has_feature": (c.c_int, text),
    "method_count": (c.c_size_t,), "method_name": (text, c.c_size_t),
    "splitting_count": (c.c_size_t,), "splitting_name": (text, c.c_size_t),
    "effect_count": (c.c_size_t,), "effect_name": (text, c.c_size_t),
    "splitting_flows": (c.c_int, text, c.c_size_t, pointer, pointer, c.POINTER(c.c_size_t)),
    "body_create": (c.c_int, pointer, c.POINTER(pointer)),
    "body_create_tensor": (c.c_int, pointer, c.POINTER(pointer), pointer),
    "body_destroy": (None, c.POINTER(pointer)),
    "rotate": (c.c_int, pointer, text, c.c_double, c.c_size_t, c.c_size_t, pointer, pointer, pointer),
    "plan_create": (c.c_int, c.POINTER(pointer)),
    "plan_destroy": (None, c.POINTER(pointer)),
    "plan_add_class": (c.c_int, pointer, pointer, c.POINTER(c.c_int)),
    "plan_add_class_tensor": (c.c_int, pointer, pointer, c.POINTER(c.c_int)),
    "plan_find_class": (c.c_int, pointer, pointer, c.c_double, c.POINTER(c.c_int)),
    "plan_class_axes": (c.c_int, pointer, c.c_int, pointer),
    "plan_set": (c.c_int, pointer, text, text),
    "plan_add_effect": (c.c_int, pointer, text, text),
    "plan_ready": (c.c_int, pointer),
    "plan_message": (c.c_size_t, pointer, text, c.c_size_t),
    "bodies_check": (c.c_int, pointer, c.POINTER(Bodies), text, c.c_size_t),
    "drift": (c.c_int, pointer, c.POINTER(Bodies), c.c_double),
    "kick": (c.c_int, pointer, c.POINTER(Bodies), c.c_double, pointer*3, c.c_ssize_t),
    "dissipate": (c.c_int, pointer, c.POINTER(Bodies), c.c_double, c.c_int64),
    "step": (c.c_int, pointer, c.POINTER(Bodies), c.c_double, c.c_double, c.c_int64, c.c_int64, TorqueFunction, pointer),
    "energy": (c.c_int, pointer, c.POINTER(Bodies), c.c_double, pointer, pointer),
    "momentum": (c.c_int, pointer, c.POINTER(Bodies), pointer),
    "degrees_of_freedom": (c.c_int, pointer, c.POINTER(Bodies), c.POINTER(c.c_size_t)),
    "moments_check": (c.c_int, pointer, text, c.c_size_t),
    "inertia_check": (c.c_int, pointer, text, c.c_size_t),
    "inertia_of_points": (c.c_int, c.c_size_t, pointer, pointer, pointer, pointer),
    "principal_axes": (c.c_int, pointer, pointer, pointer),
    "quaternion_from_euler": (c.c_int, c.c_size_t, text, pointer, pointer),
    "quaternion_to_euler": (c.c_int, c.c_size_t, text, pointer, pointer),
    "quaternion_random": (c.c_int, c.c_size_t, c.c_int64, pointer),
}

#: Functions of n elements by how many arrays they have: a status, (n, arrays, ...).
_of_arrays = {
    2: ["quaternion_" + name for name in ("conjugate", "inverse", "normalize", "exp", "log", "to_matrix", "from_matrix", "nearest",
                                          "from_rotation_vector", "to_rotation_vector", "from_cayley", "to_cayley")],
    3: ["elliptic_k", "elliptic_e", "carlson_rc", *("quaternion_" + name for name in (
        "multiply", "rotate", "rotate_back", "from_axis_angle", "to_axis_angle", "shortest_arc", "distance"))],
    4: ["jacobi_am", "elliptic_pi", "elliptic_f", "elliptic_e_incomplete", "carlson_rf", "carlson_rd", "quaternion_slerp"],
    5: ["elliptic_pi_incomplete", "carlson_rj"],
    6: ["jacobi"],
}
_signatures.update({name: (c.c_int, c.c_size_t, *[pointer]*k) for k, several in _of_arrays.items() for name in several})


def package_file(*patterns: str) -> Optional[Path]:
    """The first file of the package that is called so, in any of its folders: an editable install has two."""
    import poinsot

    for folder in poinsot.__path__:
        for pattern in patterns:
            for found in sorted(Path(folder).glob(pattern)):
                return found
    return None


def _load() -> c.CDLL:
    """The library. The package's own is asked for by one without code that needs it: so the loader chooses the level."""
    name = os.environ.get("POINSOT_LIBRARY") or package_file("lib/libpoinsot_any.so", "lib/libpoinsot*.so.*", "lib/libpoinsot*.dylib")
    if name is None:
        raise ImportError("poinsot: the package contains no library; install it with pip, or name a libpoinsot.so in the "
                          "environment variable POINSOT_LIBRARY")
    found = c.CDLL(os.fspath(name))
    for function, (result, *arguments) in _signatures.items():
        entry = getattr(found, "poinsot_" + function)
        entry.restype, entry.argtypes = result, arguments
    return found


library = _load()


def status_text(status: int) -> str:
    """What a status means, in the library's words."""
    return str(library.poinsot_status_text(status).decode())


def check(status: int, message: str = "") -> None:
    """Raise poinsot.Error unless the status is OK: with the sentence, or with the meaning of the status."""
    if status:
        raise Error(status, message or status_text(status))


def check_bodies(status: int, each: np.ndarray, given: bool, message: str = "") -> None:
    """The same after a call on bodies. If some failed and the caller did not give an array for their statuses, raise."""
    if status == Status.PARTIAL:
        if given:
            return
        failed = np.flatnonzero(each)
        first = int(failed[0])
        message = f"{len(failed)} of {len(each)} bodies failed, the first of them body {first}: {status_text(int(each[first]))}"
        raise Error(status, message, each=each)
    check(status, message)


def sentence(function: Any, *arguments: Any) -> str:
    """The text that a function of the library writes into a buffer, its last two arguments, and whose length it returns."""
    buffer = c.create_string_buffer(1024)
    length = function(*arguments, buffer, len(buffer))
    if length >= len(buffer):
        buffer = c.create_string_buffer(length + 1)
        function(*arguments, buffer, len(buffer))
    return buffer.value.decode(errors="replace")


def sentence_of_status(function: Any, *arguments: Any, of: Optional[int] = None) -> str:
    """The same of a function that returns a status; "" if it is another than `of`."""
    buffer = c.create_string_buffer(1024)
    status = function(*arguments, buffer, len(buffer))
    if of is not None and status != of:
        return ""
    return buffer.value.decode(errors="replace")


def names(kind: str) -> tuple[str, ...]:
    """Names of methods, splittings or effects, in the library's order."""
    name = getattr(library, f"poinsot_{kind}_name")
    return tuple(name(i).decode() for i in range(getattr(library, f"poinsot_{kind}_count")()))


def version() -> str:
    """Version of the library, as "0.2.0"."""
    number = library.poinsot_version()
    return f"{number//10000}.{number//100 % 100}.{number % 100}"


def has_feature(name: str) -> bool:
    """Whether this build has a feature: "openmp", "avx2", "avx512", ..."""
    return bool(library.poinsot_has_feature(name.encode()))


def splitting_flows(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients of a splitting, for programs that run the steps themselves: (kick, drift), in units of the step size.

    One step of length h is, for every i, a kick over kick[i] h, then a drift over drift[i] h; zeros are left out.
    """
    kick, drift, count = np.zeros(32), np.zeros(32), c.c_size_t()
    check(library.poinsot_splitting_flows(name.encode(), len(kick), kick.ctypes.data, drift.ctypes.data, c.byref(count)))
    return kick[:count.value].copy(), drift[:count.value].copy()
