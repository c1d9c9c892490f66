# Time against the error of the attitude: what accuracy costs.
# `gnuplot plot_attitude_cost.gp`, in this folder, draws attitude_cost.svg and attitude_cost.png.
load 'study.gp'
picture = 'attitude_cost'
quantity = 'attitude, radians'
error = 7; worst = 8; on_front = 28; shown = 30; rival = 2   # columns of cost.csv and rivals.csv
doubt = doubt_angle
strong = angle_front
array names[larger(1, strong)]
do for [k=1:strong] { names[k] = angle_names[k] }
load 'cost_curves.gp'
