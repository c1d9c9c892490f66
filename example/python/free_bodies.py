"""Free bodies from Python, by ctypes alone or with NumPy arrays: python free_bodies.py [libpoinsot.so]"""
import ctypes
import sys

library = ctypes.CDLL(sys.argv[1] if len(sys.argv) > 1 else "libpoinsot.so")
library.poinsot_status_text.restype = ctypes.c_char_p
doubles = ctypes.POINTER(ctypes.c_double)
library.poinsot_rotate.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_double, ctypes.c_size_t, ctypes.c_size_t,
                                   doubles, doubles, ctypes.POINTER(ctypes.c_int)]


class Body:
    """A kind of body, from its principal moments of inertia."""

    def __init__(self, moments):
        self.handle = ctypes.c_void_p()
        must(library.poinsot_body_create((ctypes.c_double*3)(*moments), ctypes.byref(self.handle)))

    def __del__(self):
        library.poinsot_body_destroy(ctypes.byref(self.handle))

    def rotate(self, method, h, steps, y, q):
        """Turn n bodies in place: y of shape (n, 3), q of shape (n, 4), NumPy arrays of float64 in C order."""
        n = len(y)
        if y.shape != (n, 3) or q.shape != (n, 4) or not (y.flags.c_contiguous and q.flags.c_contiguous) \
                or y.dtype != "float64" or q.dtype != "float64":
            raise ValueError("y (n, 3) and q (n, 4) must be float64 in C order")
        must(library.poinsot_rotate(self.handle, method.encode(), h, steps, n, y.ctypes.data_as(doubles),
                                    q.ctypes.data_as(doubles), None))


def must(status):
    """Raise what the library answers."""
    if status:
        raise RuntimeError(library.poinsot_status_text(status).decode())


def main():
    """The first figure of Vilmart's review: T = 40."""
    import numpy
    y = numpy.tile([0.0, 0.6, -0.8], (10000, 1))
    q = numpy.tile([1.0, 0.0, 0.0, 0.0], (10000, 1))
    Body([0.376, 0.627, 1.0]).rotate("exact", 0.01, 4000, y, q)
    print("y =", y[0], "  q =", q[0])
    assert abs(y - [0.0545936805170048, -0.5930307093190378, -0.8033268997439126]).max() < 1e-11
    assert (y == y[0]).all() and (q == q[0]).all()


if __name__ == "__main__":
    main()
