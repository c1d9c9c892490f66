"""What accuracy costs on the heavy top: time against error of a few splittings and taylor, measured on this machine.

python what_accuracy_costs.py [PICTURE [BUDGET]]     what_accuracy_costs.png, where matplotlib is installed, within 20s
"""
import sys

import numpy
import poinsot

picture = sys.argv[1] if len(sys.argv) > 1 else "what_accuracy_costs.png"
budget = sys.argv[2] if len(sys.argv) > 2 else "20s"
cost = poinsot.cost("heavy-top", methods=["exact"], splittings=["strang", "srkn4", "srkn6", "omelyan8", "taylor"], budget=budget)

# taylor is no splitting: it takes steps of its own within those of the scene.
ways = [str(method if splitting == "-" else splitting) for method, splitting in zip(cost.points["method"], cost.points["splitting"])]
print("tolerance  cheapest      step  ns per unit of time")
for tolerance in (1e-3, 1e-6, 1e-9, 1e-12):
    row = cost.cheapest(tolerance)
    if row is not None:
        print(f"{tolerance:9.0e}  {ways[list(cost.points).index(row)]:10} {row['h']:7.4f} {row['ns_per_time']:20.0f}")

try:
    import matplotlib
except ImportError:
    print("no matplotlib, no picture")
    sys.exit()
matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

for name in dict.fromkeys(ways):
    rows = (numpy.array(ways) == name) & (cost.points["ns_per_time"] > 0)
    pyplot.loglog(cost.error[rows], cost.points["ns_per_time"][rows], "o-", markersize=4, label=name)
pyplot.title("heavy top, exact rotation, this machine")
pyplot.xlabel("error at the end")
pyplot.ylabel("ns per body and unit of time")
pyplot.legend()
pyplot.savefig(picture, dpi=150)
