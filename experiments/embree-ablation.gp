# SPDX-License-Identifier: Apache-2.0
# embree-ablation: throughput over that of the default `wide`, one line per variant, one panel per scene, one mark per ray kind.
#: 1-ablation: Throughput of variants of wide over that of the default, one line per variant, one panel per scene, one marker per
#:   ray kind. Medians with intervals, on a logarithmic axis; left of 1 the variant is slower.

n_scenes = words(scenes); n_kinds = words(kinds); n_accels = words(accels)
chosen(s, a, k) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a) && strcol("kind") eq word(kinds, k)
height(a, k) = n_accels - a + 0.14 * (0.5 * (n_kinds + 1) - k)

set logscale x 2
set xrange [0.035 : 1.8]
set xtics ("1/16" 1.0 / 16, "" 0.125, "1/4" 0.25, "" 0.5, "1" 1)
set yrange [-0.5 : n_accels - 1.5]
set grid xtics ytics
set bars small

height = 140 + 40 * (n_accels - 1)
eval canvas("1-ablation", 960, height)
set multiplot layout 1, n_scenes margins screen 0.2, 0.99, 66.0 / height, 1 - 72.0 / height spacing screen 0.012, 0.1
do for [s = 1:n_scenes] {
  set title word(scenes, s) font ",14" textcolor rgb ink
  set xlabel (s == (n_scenes + 1) / 2 ? "throughput / that of wide" : "") textcolor rgb ink
  set ytics ()
  do for [a = 2:n_accels] { set ytics add ((s == 1 ? word(accels, a) : "") n_accels - a) }
  if (s == 1) { set key at screen 0.985, screen 1 - 8.0 / height right top vertical maxrows 1 samplen 1 textcolor rgb ink } else { unset key }
  plot for [k = 1:n_kinds] for [a = 2:n_accels] "times.csv" \
         using (chosen(s, a, k) ? column("ratio") : NaN):(height(a, k)):(column("ratio_low")):(column("ratio_high")) \
         with xerrorbars linewidth 1.3 pointtype mark(k) pointsize 0.8 linecolor rgb hue(k) title (a == 2 ? word(kinds, k) : "")
}
unset multiplot
unset output
