"""The app that comes with the package: as a command, and for poinsot.run, cost and choose."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from typing import Optional, Union

from ._library import Error, Status, package_file

PathLike = Union[str, "os.PathLike[str]"]

#: What an exit code of the app means.
_statuses = {1: Status.IO, 2: Status.SCENE, 3: Status.PARTIAL, 4: Status.CONVERGENCE}
_patience = 30  #: seconds that the app has to leave its files whole when it is interrupted


def app() -> str:
    """The app's file."""
    name = os.environ.get("POINSOT_APP") or package_file("bin/poinsot")
    if name is None:
        raise FileNotFoundError("the package contains no app; set the environment variable POINSOT_APP to its file")
    return os.fspath(name)


def call(arguments: Sequence[str], folder: Optional[PathLike] = None) -> tuple[int, str, str]:
    """Run the app in a folder: its exit code, output and errors. Ctrl-C ends it as it ends a run in a terminal."""
    with subprocess.Popen([app(), *arguments], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, errors="replace") as process:
        try:
            output, errors = process.communicate()
        except BaseException:
            process.send_signal(signal.SIGINT)
            try:
                process.communicate(timeout=_patience)
            except subprocess.TimeoutExpired:
                process.kill()
            raise
    return process.returncode, output, errors


def error(code: int, errors: str) -> Error:
    """The exception for an exit code, with the app's own sentence."""
    sentence = errors.strip()
    if sentence.startswith("poinsot: "):
        sentence = sentence[len("poinsot: "):]
    if code < 0:
        sentence = f"the app was ended by {signal.Signals(-code).name}. {sentence}".strip()
    return Error(_statuses.get(code, Status.IO), sentence or f"the app ended with exit code {code}")


def main() -> int:
    """The command `poinsot`: the app in place of this process."""
    os.execv(app(), ["poinsot", *sys.argv[1:]])


if __name__ == "__main__":
    main()
