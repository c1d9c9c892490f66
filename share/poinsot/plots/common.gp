# What the plot scripts of a folder share: terminals, colours, names at the ends of curves.
#
# Say otherwise on the command line, as in `gnuplot -e "kinds = 'pngcairo'; dots = 960" plot_drift.gp`:
#    kinds   the files drawn: svg, pngcairo, or both
#    dots    width of the PNG; 0: two dots for each point of the picture
if (!exists('kinds')) kinds = 'svg pngcairo'
if (!exists('dots')) dots = 0

# `eval begin(kind, 'drift', 720, 400)` begins drift.svg or drift.png, so many points wide and high.
begin(kind, name, width, height) = "reset; set encoding utf8; set datafile separator ','; " . (kind eq 'svg' ? \
   sprintf("set terminal svg size %d,%d dynamic background '#ffffff' font 'DejaVu Sans,12'; set output '%s.svg'", \
      width, height, name) : png(name, width, height, dots > 0 ? 1.0*dots/width : 2))
png(name, width, height, scale) = \
   sprintf("set terminal pngcairo size %d,%d font 'DejaVu Sans,12' fontscale %g linewidth %g pointscale %g; set output '%s.png'", \
      scale*width, scale*height, scale, scale, scale, name)
can_draw(kind) = strstrt(GPVAL_TERMINALS, kind) > 0

# Okabe and Ito's colours, darkened where they are too pale on white, dark and light in turn; a shape of points for each.
array colours[8] = ['#0b3c6f', '#d55e00', '#007a5a', '#b0539a', '#2f8fce', '#8a6d00', '#000000', '#a00000']
array shapes[8] = [7, 5, 9, 13, 6, 4, 8, 12]
colour(k) = colours[1 + (k - 1)%8]
shape(k) = shapes[1 + (k - 1)%8]
dark = '#1f3f66'    # what a picture is about
pale = '#b4c2d2'    # the same on the far side

# Round numbers for axes: a step with at most n ticks in a range, and ends of a logarithmic axis at 1, 2 or 5.
power(x) = 10.0**floor(log10(x))
round_up(x) = x <= power(x)*1.000001 ? power(x) : x <= 2*power(x) ? 2*power(x) : x <= 5*power(x) ? 5*power(x) : 10*power(x)
round_down(x) = x >= 5*power(x) ? 5*power(x) : x >= 2*power(x) ? 2*power(x) : power(x)
tick(range, n) = range > 0 ? round_up(1.0*range/n) : 1

larger(a, b) = a > b ? a : b
smaller(a, b) = a < b ? a : b
