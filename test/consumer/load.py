"""Load the shared library with dlopen, as a host does that was linked with none of what the library needs."""
import ctypes
import sys

library = ctypes.CDLL(sys.argv[1])
if len(sys.argv) > 2:
    library.poinsot_status_text.restype = ctypes.c_char_p
    major, minor, patch = (int(part) for part in sys.argv[2].split("."))
    assert library.poinsot_version() == 10000*major + 100*minor + patch
    assert library.poinsot_status_text(0) == b"ok"
print("consumer: ok")
