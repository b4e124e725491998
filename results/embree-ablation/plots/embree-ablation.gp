# SPDX-License-Identifier: Apache-2.0
# embree-ablation: throughput over that of `wide` as it is, a variant a line, a panel a scene, a mark a ray kind.

n_scenes = words(scenes); n_kinds = words(kinds); n_accels = words(accels)
chosen(s, a, k) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a) && strcol("kind") eq word(kinds, k)
hue(k) = word("#222222 #c1543c #2f6f9f #3a8a4d #8a5aa8", k)
mark(k) = int(word("5 9 7 13 11", k))
height(a, k) = n_accels - a + 0.14 * (0.5 * (n_kinds + 1) - k)

set logscale x
set xrange [0.12 : 1.8]
set xtics ("⅛" 0.125, "¼" 0.25, "½" 0.5, "1" 1, "1.5" 1.5)
set yrange [-0.5 : n_accels - 1.5]
set grid xtics ytics
set bars small

eval svg("1-ablation", 190 + 250 * n_scenes, 90 + 44 * (n_accels - 1))
set multiplot layout 1, n_scenes margins screen 0.145, 0.985, 0.09, 0.86 spacing screen 0.012, 0.1
do for [s = 1:n_scenes] {
  set title word(scenes, s) font ",14" textcolor rgb ink
  set xlabel "throughput / that of wide" textcolor rgb ink
  set ytics () font ",12"
  do for [a = 2:n_accels] { set ytics add ((s == 1 ? word(accels, a) : "") n_accels - a) }
  if (s == 1) { set key at screen 0.985, screen 0.985 right top vertical maxrows 1 samplen 1 textcolor rgb ink } else { unset key }
  plot for [k = 1:n_kinds] for [a = 2:n_accels] "times.csv" \
         using (chosen(s, a, k) ? column("ratio") : NaN):(height(a, k)):(column("ratio_low")):(column("ratio_high")) \
         with xerrorbars linewidth 1.5 pointtype mark(k) pointsize 0.8 linecolor rgb hue(k) title (a == 2 ? word(kinds, k) : "")
}
unset multiplot
unset output
