"""Many bodies of several classes, with torques."""
from __future__ import annotations

import ctypes as c
import operator
import threading
import time
import weakref
from typing import Any, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import InPlace, read, state, written
from ._library import Bodies, Error, Status, TorqueFunction, check, check_bodies, library, sentence, sentence_of_status, status_text
from ._text import settings_text
from ._torque import Callback, Interrupts, Torque

_THREADED = 20e-3  #: seconds of work from which a team of threads is worth its start
_orders = {"wxyz": (0, 1, 2, 3), "xyzw": (3, 0, 1, 2)}  #: where w, x, y, z stand in a row


class _View(NamedTuple):
    """A call's bodies, and all arrays that must live as long as it lasts."""

    bodies: Bodies
    y: InPlace
    q: InPlace
    n: int
    each: np.ndarray
    each_given: bool
    kept: tuple[Any, ...]


class Plan:
    """What stays the same from step to step: body classes, method, splitting, effects, layout.

    >>> top = Plan(splitting="srkn6")
    >>> top.add_class([0.6, 0.8, 1.0])
    0
    >>> top.add_effect("gravity", centre=[0, 0, 1], weight=1)
    >>> y, q = np.array([1.8, 0.4, -0.9]), np.array([1.0, 0.0, 0.0, 0.0])
    >>> y, q = top.step(y, q, 0.02, steps=500)
    >>> y.round(8)
    array([ 1.92257338,  0.77202323, -0.20110548])

    The first call on bodies makes the plan ready: it is checked, cannot be changed any more, and may be shared by threads.

    Parameters
    ----------
    method, splitting : str
        One of poinsot.methods() and of poinsot.splittings().
    layout : str
        What y means, and in which frame torques are: "native" (angular momentum, body frame), "lammps" (angular momentum,
        space frame), "dl_poly" (angular velocity, body frame), "hoomd" (conjugate momentum, four components).
    threads : int, optional
        Number of threads; 0 is OpenMP's number. Without it, one, and OpenMP's number for calls that last 20 ms or more.
        Results do not depend on it.
    momentum, frame : str, optional
        Override those of the layout: "body-momentum", "space-momentum", "body-velocity", "space-velocity" or
        "conjugate-momentum"; and the frame of torques, "body" or "space".
    seed : int, optional
        Of random numbers.
    order : str
        Of the components of q: "wxyz" or "xyzw".
    options
        Any other option of poinsot_plan_set.

    Bodies
    ------
    Every call on bodies has arguments `y`, float64 of shape (3,) or (n, 3), (4,) or (n, 4) for a conjugate momentum, and
    `q`, float64 of shape (4,) or (n, 4). Strided views are accepted: ``y = particles[:, 0:3]``, or Fortran order.
    Optional keyword arguments:

    body_class : integers, shape (n,)
        The class of each body; without it, all are of class 0. Bodies of a negative class are skipped.
    id : integers, shape (n,)
        Number of each body for its random numbers; without it, the position.
    carry : numpy.ndarray of float64, shape (n, 7)
        Low-order parts of compensated sums, zero at the start, kept by the caller from call to call.
    scale : numbers, shape (n,)
        Moments of each body over those of its class.
    moments : numbers, shape (n, 3)
        Or the moments of each body.
    y_at, q_at : integers, shape (n,)
        The rows of y and of q that belong to each body; without them, body i is row i. All other arrays are indexed by body.
    status : numpy.ndarray of int32, shape (n,)
        Receives the status of each body; bodies that fail then raise no exception.
    """

    def __init__(self, method: str = "exact", splitting: str = "srkn6", layout: str = "native", threads: Optional[int] = None,
                 *, momentum: Optional[str] = None, frame: Optional[str] = None, seed: Optional[int] = None,
                 order: str = "wxyz", **options: Union[str, float]) -> None:
        if order not in _orders:
            raise ValueError(f"order must be 'wxyz' or 'xyzw', not '{order}'")
        self._order, self._places = order, _orders[order]
        self._record: list[tuple[Any, ...]] = []
        self._threads = None if threads is None else operator.index(threads)
        self._lock = threading.Lock()
        self._ready = False
        self._pace = {"drift": 4e-9, "kick": 2e-9, "dissipate": 1e-8, "step": 4e-8}  # seconds of a body and step, until they are measured
        self._one = _create(1 if self._threads is None else self._threads)
        self._team: Optional[c.c_void_p] = None
        weakref.finalize(self, _destroy, self._one)
        self._components = 4 if momentum == "conjugate-momentum" or (momentum is None and layout == "hoomd") else 3
        settings = {"method": method, "splitting": splitting, "layout": layout, "momentum": momentum, "frame": frame,
                    "seed": seed, **options}
        for option, value in settings.items():
            if value is not None:
                self._do("plan_set", option.encode(), str(value).encode())

    # ---- what is in it ---------------------------------------------------------------------------------------------------

    def add_class(self, moments: ArrayLike) -> int:
        """Add a body class by its principal moments, in any order; returns its number, from 0."""
        return self._add("plan_add_class", read("moments", moments, (3,)).copy())

    def add_class_tensor(self, tensor: ArrayLike) -> int:
        """Add a body class by its inertia tensor, shape (3, 3). y, q and torques of its bodies refer to the tensor's frame."""
        return self._add("plan_add_class_tensor", read("tensor", tensor, (3, 3)).copy())

    def find_class(self, moments: ArrayLike, tolerance: float = 1e-6) -> int:
        """The number of the class whose moments are nearest to these, axis by axis, or of a new one.

        Only classes within `tolerance` times the largest moment count; of several the first is used. For moments computed from
        coordinates, which differ slightly for every water molecule. Classes made from tensors are not considered.
        """
        return self._add("plan_find_class", read("moments", moments, (3,)).copy(), float(tolerance))

    def class_axes(self, number: int) -> np.ndarray:
        """Principal axes of a class, as columns, in the frame that it was given in: shape (3, 3)."""
        axes = np.empty((3, 3))
        check(library.poinsot_plan_class_axes(self._one, operator.index(number), axes.ctypes.data),
              f"there is no class {number} in the plan")
        return axes

    def add_effect(self, name: str, *, body_class: Optional[int] = None, **keys: Any) -> None:
        """Add an effect by name (poinsot.effects()) with its keys, which `poinsot effects NAME` explains: numbers, arrays, strings.

        `body_class` is the class that it acts on, from 0; without it, it acts on all.
        """
        if "class" in keys:
            raise TypeError("give the class that an effect acts on as body_class, from 0")
        if body_class is not None:
            keys["class"] = operator.index(body_class) + 1
            if keys["class"] < 1:
                raise ValueError(f"body_class = {body_class} must not be negative")
        self._do("plan_add_effect", name.encode(), settings_text(keys).encode())

    def ready(self) -> Plan:
        """Check the plan and make it ready now. The first call on bodies does the same."""
        with self._lock:
            if not self._ready:
                self._check(library.poinsot_plan_ready(self._one))
                self._ready = True
        return self

    def _add(self, function: str, *values: Any) -> int:
        number = c.c_int()
        self._do(function, *values, c.byref(number), record=(*values, None))
        return number.value

    def _do(self, function: str, *arguments: Any, record: Optional[tuple[Any, ...]] = None) -> None:
        """Call a function that changes the plan, and remember it for a copy of the plan: with these arguments, or with others."""
        if self._ready:
            raise Error(Status.DOMAIN, "the plan is ready and cannot be changed: set classes, effects and options before the first "
                                       "call on bodies")
        self._check(_call(function, self._one, arguments))
        self._record.append((function, *(arguments if record is None else record)))

    def _check(self, status: int) -> None:
        if status:
            check(status, sentence(library.poinsot_plan_message, self._one))

    def __reduce__(self) -> Any:
        return _rebuild, (type(self), self._order, self._components, self._threads, self._record)

    # ---- bodies ----------------------------------------------------------------------------------------------------------

    def drift(self, y: np.ndarray, q: np.ndarray, h: float, **bodies: Any) -> tuple[np.ndarray, np.ndarray]:
        """Free rotation of all bodies over h by the plan's method, in place; returns (y, q)."""
        return self._change("drift", y, q, bodies, 1, h)

    def dissipate(self, y: np.ndarray, q: np.ndarray, h: float, step: int, **bodies: Any) -> tuple[np.ndarray, np.ndarray]:
        """Apply the plan's drag and thermostats over h, as in step number `step`, in place; returns (y, q).

        Between two drifts of h/2 it is bitwise what the splitting "baoab" does.
        """
        return self._change("dissipate", y, q, bodies, 1, h, step)

    def kick(self, y: np.ndarray, q: np.ndarray, h: float, torque: ArrayLike, **bodies: Any) -> tuple[np.ndarray, np.ndarray]:
        """y += h torque, in place; torque has the shape (3,) or (n, 3), in the frame of the layout. Returns (y, q)."""
        given = np.asarray(torque, dtype=np.float64)
        if given.ndim not in (1, 2) or given.shape[-1] != 3:
            raise ValueError(f"torque must have the shape (3,) or (n, 3), not {given.shape}")
        rows = np.ascontiguousarray(given).reshape(-1, 3)
        first = rows.ctypes.data
        columns = (c.c_void_p*3)(first, first + 8, first + 16)
        return self._change("kick", y, q, bodies, 1, h, columns, 3, expected=len(rows))

    def step(self, y: np.ndarray, q: np.ndarray, h: float, steps: int = 1, t: float = 0.0, first: int = 0,
             torque: Optional[Torque] = None, **bodies: Any) -> tuple[np.ndarray, np.ndarray]:
        """Take steps of size h by the plan's splitting, with its effects and the torque, in place; returns (y, q).

        Parameters
        ----------
        steps : int
            Number of steps.
        t : float
            Step k begins at t + k h.
        first : int
            Number of the first step. It also selects the random numbers: continue with first + steps.
        torque : function, optional
            torque(t, q) returns the torques of all bodies at time t, shape (n, 3), in the frame of the layout; q has the shape
            (n, 4). With y and q of one body, (3,) and (4,), it gets a q of shape (4,) and returns three numbers. An exception in
            it, or Ctrl-C, stops the steps: all bodies then have their states from before the interrupted step.
        """
        count, number = operator.index(steps), operator.index(first)
        if torque is None:
            return self._change("step", y, q, bodies, count, t, h, number, count, TorqueFunction(), None)
        view = self._open(y, q, bodies)
        self.ready()
        with Interrupts() as interrupts:
            callback = Callback(torque, view.n, view.y.single, self._places, interrupts)
            status = library.poinsot_step(self._one, view.bodies, t, h, number, count, callback.entry, None)
        self._close(view)
        if callback.failure is not None:
            raise callback.failure
        self._check_bodies(status, view)
        return y, q

    def energy(self, y: ArrayLike, q: ArrayLike, t: float = 0.0, **bodies: Any) -> tuple[Any, Any]:
        """Kinetic and potential energy of each body at time t: two arrays, or two numbers for one body."""
        view = self._look(y, q, bodies)
        kinetic, potential = np.zeros(view.n), np.zeros(view.n)
        self._check_bodies(library.poinsot_energy(self._one, view.bodies, t, kinetic.ctypes.data, potential.ctypes.data), view)
        return (kinetic[0], potential[0]) if view.y.single else (kinetic, potential)

    def momentum(self, y: ArrayLike, q: ArrayLike, **bodies: Any) -> np.ndarray:
        """Angular momentum of each body in the space frame, of the shape of y (three components)."""
        view = self._look(y, q, bodies)
        momenta = np.zeros((view.n, 3))
        self._check_bodies(library.poinsot_momentum(self._one, view.bodies, momenta.ctypes.data), view)
        return momenta[0] if view.y.single else momenta

    def degrees_of_freedom(self, y: ArrayLike, q: ArrayLike, **bodies: Any) -> int:
        """Rotational degrees of freedom of all bodies: 3 each, 2 for a linear one."""
        view = self._look(y, q, bodies)
        count = c.c_size_t()
        self._check_bodies(library.poinsot_degrees_of_freedom(self._one, view.bodies, c.byref(count)), view)
        return count.value

    def _open(self, y: np.ndarray, q: np.ndarray, given: dict[str, Any]) -> _View:
        """The caller's arrays as the library sees them."""
        momenta, attitudes = state(y, q, self._components)
        n, rows = _count(momenta, attitudes, given)
        bodies = Bodies(size=c.sizeof(Bodies), n=n, y_stride=momenta.stride, q_stride=attitudes.stride, rows=rows)
        bodies.y[:] = [momenta.component(j) for j in range(3)]
        bodies.q[:] = [attitudes.component(j) for j in self._places]
        if self._components == 4:
            bodies.y_fourth = momenta.component(3)
        each = given.pop("status", None)
        each_given = each is not None
        each = written("status", each, (n,), np.int32) if each_given else np.zeros(n, np.int32)
        bodies.status = each.ctypes.data
        kept = [self._given(bodies, name, given.pop(name), n) for name in list(given) if name in _members]
        if given:
            raise TypeError(f"unknown argument '{next(iter(given))}'; allowed are {', '.join(_members)} and status")
        return _View(bodies, momenta, attitudes, n, each, each_given, tuple(kept))

    @staticmethod
    def _given(bodies: Bodies, name: str, values: Any, n: int) -> Optional[np.ndarray]:
        """An optional array of the view."""
        if values is None:
            return None
        width, dtype, changed = _members[name]
        shape = (n, width) if width else (n,)
        array = (written if changed else read)(name, values, shape, dtype)
        first = array.ctypes.data
        if name == "moments":
            bodies.moments[:] = [first, first + 8, first + 16]
            bodies.moments_stride = 3
        else:
            setattr(bodies, name, first)
        return array

    def _look(self, y: ArrayLike, q: ArrayLike, given: dict[str, Any]) -> _View:
        """The same of states that are only read: any array-like."""
        self.ready()
        return self._open(_own(y), _own(q), given)

    def _close(self, view: _View) -> None:
        view.y.finish()
        view.q.finish()

    def _check_bodies(self, status: int, view: _View) -> None:
        message = ""
        if status not in (Status.OK, Status.PARTIAL):
            message = (sentence_of_status(library.poinsot_bodies_check, self._one, view.bodies, of=status)
                       or status_text(status))
        check_bodies(status, view.each, view.each_given, message)

    def _change(self, function: str, y: np.ndarray, q: np.ndarray, given: dict[str, Any], steps: int, *arguments: Any,
                expected: Optional[int] = None) -> tuple[np.ndarray, np.ndarray]:
        """A call that changes states, by one thread or by a team."""
        view = self._open(y, q, given)
        if expected is not None and expected != view.n:
            raise ValueError(f"torque has {expected} rows for {view.n} bodies")
        self.ready()
        work = view.n*steps
        plan = self._of_threads(work*self._pace[function])
        begin = time.perf_counter()
        status = getattr(library, "poinsot_" + function)(plan, view.bodies, *arguments)
        if plan is self._one and work > 0:
            self._pace[function] = (time.perf_counter() - begin)/work
        self._close(view)
        self._check_bodies(status, view)
        return y, q

    def _of_threads(self, seconds: float) -> c.c_void_p:
        """The plan for so much work: this one, or its copy whose threads are as many as OpenMP says."""
        if self._threads is not None or seconds < _THREADED:
            return self._one
        with self._lock:
            if self._team is None:
                team = _create(0)
                weakref.finalize(self, _destroy, team)
                _replay(team, self._record)
                check(library.poinsot_plan_ready(team))
                self._team = team
        return self._team


#: Optional arrays of a view: components, type, and does the library write into it?
_members: dict[str, tuple[int, Any, bool]] = {
    "body_class": (0, np.int32, False), "id": (0, np.int64, False), "carry": (7, np.float64, True),
    "scale": (0, np.float64, False), "moments": (3, np.float64, False), "y_at": (0, np.int32, False), "q_at": (0, np.int32, False)}


def _count(y: InPlace, q: InPlace, given: dict[str, Any]) -> tuple[int, int]:
    """How many bodies, and how many rows there are to choose from; 0 if no rows are chosen."""
    lengths, rows = {}, set()
    for name, array in (("y", y), ("q", q)):
        chosen = given.get(name + "_at")
        lengths[name if chosen is None else name + "_at"] = len(array) if chosen is None else len(chosen)
        if chosen is not None:
            rows.add(len(array))
    if len(rows) > 1:
        raise ValueError(f"y has {len(y)} rows and q has {len(q)}: with y_at and q_at they must have as many")
    if len(set(lengths.values())) > 1:
        raise ValueError(", ".join(f"{name} has {k} rows" for name, k in lengths.items()) + ": one of each for every body")
    return next(iter(lengths.values())), max(rows, default=0)


def _create(threads: int) -> c.c_void_p:
    plan = c.c_void_p()
    check(library.poinsot_plan_create(c.byref(plan)))
    status = library.poinsot_plan_set(plan, b"threads", str(threads).encode())
    if status:
        message = sentence(library.poinsot_plan_message, plan)
        _destroy(plan)
        check(status, message)
    return plan


def _destroy(plan: c.c_void_p) -> None:
    library.poinsot_plan_destroy(c.byref(plan))


def _call(function: str, plan: c.c_void_p, arguments: tuple[Any, ...]) -> int:
    values = [a.ctypes.data if isinstance(a, np.ndarray) else a for a in arguments]
    return int(getattr(library, "poinsot_" + function)(plan, *values))


def _replay(plan: c.c_void_p, record: list[tuple[Any, ...]]) -> None:
    for function, *arguments in record:
        check(_call(function, plan, tuple(arguments)), sentence(library.poinsot_plan_message, plan))


def _rebuild(kind: type, order: str, components: int, threads: Optional[int], record: list[tuple[Any, ...]]) -> Plan:
    """A plan that takes changes again, from what another one remembers."""
    plan: Plan = kind(threads=threads, order=order)
    plan._components = components
    for function, *arguments in record:
        plan._do(function, *arguments)
    return plan


def _own(values: ArrayLike) -> np.ndarray:
    """States to look at: float64 and writeable, as the view wants them; a copy only if they are not."""
    array = np.asarray(values, dtype=np.float64)
    return array if array.flags.writeable else array.copy()
