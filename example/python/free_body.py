"""The review's figure 1: the axes of a book, thrown with a spin, as they travel over the unit sphere.

python free_body.py [PICTURE]       prints the end; draws free_body.png where matplotlib is installed
"""
import sys

import numpy as np
import poinsot

published = [0.0545936805170048, -0.5930307093190378, -0.8033268997439126]
book = poinsot.Body([0.376, 0.627, 1.0])
y = np.array([0.0, 0.6, -0.8])  # angular momentum, body frame
q = np.array([1.0, 0.0, 0.0, 0.0])  # attitude, scalar first
trajectory = [q.copy()]
for _ in range(2000):
    book.rotate(y, q, 0.02)
    trajectory.append(q.copy())

print("y at t = 40 ", y)
print("published   ", np.array(published))
assert abs(y - published).max() < 1e-12

# The columns of the rotation matrix: where each body axis points in space.
a, b, c, d = np.array(trajectory).T
axes = [(a*a + b*b - c*c - d*d, 2*(b*c + a*d), 2*(b*d - a*c)),
        (2*(b*c - a*d), a*a - b*b + c*c - d*d, 2*(c*d + a*b)),
        (2*(b*d + a*c), 2*(c*d - a*b), a*a - b*b - c*c + d*d)]

try:
    import matplotlib
except ImportError:
    print("no matplotlib, no picture")
    sys.exit()
matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

figure = pyplot.figure(figsize=(12, 4.4), layout="constrained")
for i, axis in enumerate(axes):
    sphere = figure.add_subplot(1, 3, i + 1, projection="3d", box_aspect=(1, 1, 1), title=f"axis {i + 1} of the body")
    sphere.plot(*axis, linewidth=0.7)
    ends = dict(zip(("xlim", "ylim", "zlim"), 3*[(-1, 1)]), **dict(zip(("xticks", "yticks", "zticks"), 3*[(-1, 0, 1)])))
    sphere.set(**ends, xlabel="x", ylabel="y", zlabel="z")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "free_body.png", dpi=150)
