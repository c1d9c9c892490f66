# Time against the error of the momentum: what accuracy costs.
# `gnuplot plot_momentum_cost.gp`, in this folder, draws momentum_cost.svg and momentum_cost.png.
load 'study.gp'
picture = 'momentum_cost'
quantity = 'momentum, over |y|'
error = 10; worst = 11; on_front = 29; shown = 31; rival = 3   # columns of cost.csv and rivals.csv
doubt = doubt_momentum
strong = momentum_front
array names[larger(1, strong)]
do for [k=1:strong] { names[k] = momentum_names[k] }
load 'cost_curves.gp'
