# SPDX-License-Identifier: Apache-2.0
# Predicted against measured cost of structures.
#: 1-predicted: Extent tests per ray over the predicted cost, a panel per kind of rays, a point per scene and structure.
#:   Logarithmic axes; on the line both are the same.

n_kinds = words(kinds); n_accels = words(accels)
given(k, a) = strcol("kind") eq word(kinds, k) && strcol("accel") eq word(accels, a) ? column("predicted_cost") : NaN
measured(i) = column("extent_tests") / column("rays")

eval canvas("1-predicted", 960, 480)
set multiplot layout 1, n_kinds margins screen 0.095, 0.965, 0.12, 0.82 spacing screen 0.06, 0.1
set logscale xy
set grid xtics ytics
set xlabel "predicted cost" textcolor rgb ink
do for [k = 1:n_kinds] {
  if (k == 1) { set ylabel "extent tests per ray" textcolor rgb ink } else { unset ylabel }
  if (k < n_kinds) { unset key }
  else { set key at screen 0.98, screen 0.98 right top vertical maxrows 1 samplen 1 noenhanced textcolor rgb ink }
  set title word(kinds, k) font ",13" textcolor rgb ink
  plot x with lines linewidth 0.7 linecolor rgb soft notitle, \
       for [a = 1:n_accels] "counts.csv" using (given(k, a)):(measured(0)) with points pointtype mark(a) pointsize 0.8 \
         linecolor rgb hue(a) title word(accels, a)
}
unset multiplot
unset output
