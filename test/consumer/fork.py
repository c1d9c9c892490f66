"""After use with threads, children made by fork use the library too: usage fork.py libpoinsot.so"""
import ctypes
import os
import signal
import sys

library = ctypes.CDLL(sys.argv[1])
doubles = ctypes.c_double*3
n = 20000
body = ctypes.c_void_p()
assert library.poinsot_body_create(doubles(0.6, 0.8, 1.0), ctypes.byref(body)) == 0
y = (ctypes.c_double*(3*n))(*([0.1, 0.2, 0.3]*n))
q = (ctypes.c_double*(4*n))(*([1.0, 0.0, 0.0, 0.0]*n))


def turn():
    status = library.poinsot_rotate(body, b"exact", ctypes.c_double(0.1), ctypes.c_size_t(3), ctypes.c_size_t(n), y, q, None)
    return status == 0 and y[0] == y[3*n - 3] and q[1] == q[4*n - 3]


assert turn()                       # OpenMP has its workers now
children = []
for _ in range(3):
    child = os.fork()
    if child == 0:
        signal.alarm(60)            # a child that waits for workers it does not have
        os._exit(0 if turn() and turn() else 1)
    children.append(child)
assert turn()                       # and so has the parent, still
for child in children:
    assert os.waitpid(child, 0)[1] == 0, "a child after fork failed or waits for ever"
print("fork: ok")
