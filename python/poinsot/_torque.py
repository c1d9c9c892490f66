"""A Python function as the torque callback of poinsot_step."""
from __future__ import annotations

import ctypes as c
import signal
import threading
from types import FrameType, TracebackType
from typing import Any, Callable, Optional

import numpy as np
from numpy.typing import ArrayLike

from ._library import TorqueFunction

Torque = Callable[[float, np.ndarray], ArrayLike]


class Interrupts:
    """Ctrl-C while a torque function is in use: kept until it can be raised in Python code of ours.

    Python answers a signal when the next Python function begins. That would be the callback, before its first line, where
    ctypes prints an exception and goes on as if the function had returned.
    """

    def __init__(self) -> None:
        self._before: Any = None
        self._noted: Optional[tuple[int, Optional[FrameType]]] = None

    def __enter__(self) -> Interrupts:
        before = signal.getsignal(signal.SIGINT)
        if threading.current_thread() is threading.main_thread() and callable(before):
            signal.signal(signal.SIGINT, self._note)
            self._before = before
        return self

    def __exit__(self, kind: Optional[type[BaseException]], value: Optional[BaseException],
                 traceback: Optional[TracebackType]) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)
            self.deliver()

    def _note(self, number: int, frame: Optional[FrameType]) -> None:
        self._noted = number, frame

    def deliver(self) -> None:
        """Answer a Ctrl-C as the program would have: by KeyboardInterrupt, if it does nothing else."""
        if self._noted is not None:
            noted, self._noted = self._noted, None
            self._before(*noted)


class Callback:
    """What poinsot_step calls. An exception stops the step, is kept in `failure`, and is raised by whoever called the step."""

    def __init__(self, function: Torque, n: int, single: bool, places: tuple[int, ...], interrupts: Interrupts) -> None:
        self._function, self._n, self._single, self._places = function, n, single, places
        self._interrupts = interrupts
        self.failure: Optional[BaseException] = None
        self.entry = TorqueFunction(self._call)

    def _columns(self, addresses: Any, count: int, stride: int) -> list[np.ndarray]:
        """The library's columns as arrays, without a copy."""
        memory = c.c_double*((self._n - 1)*stride + 1)
        return [np.ndarray(self._n, np.float64, memoryview(memory.from_address(addresses[j])), strides=(8*stride,)) for j in range(count)]

    def _call(self, context: Any, t: float, n: int, q: Any, q_stride: int, torque: Any, torque_stride: int, energy: Any) -> int:
        try:
            attitudes = np.empty((n, 4))  # a copy: the function may keep it
            for place, column in zip(self._places, self._columns(q, 4, q_stride)):
                attitudes[:, place] = column
            answer = np.asarray(self._function(t, attitudes[0] if self._single else attitudes), dtype=np.float64)
            wanted = (3,) if self._single else (n, 3)
            if answer.shape != wanted:
                raise ValueError(f"torque(t, q) must return an array of shape {wanted}, not {answer.shape}")
            for j, column in enumerate(self._columns(torque, 3, torque_stride)):
                column[:] = answer[..., j]
            self._interrupts.deliver()
            return 0
        except BaseException as failure:
            self.failure = failure
            return 1
