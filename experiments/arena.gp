# SPDX-License-Identifier: Apache-2.0
# arena, arena-streams: throughput over that of Embree's best, a row per accelerator, a panel per ray kind.
#: 1-arena: Throughput over that of Embree's best, on a logarithmic scale, one panel per ray kind, a row per accelerator.
#:   Medians with intervals, one marker per scene; right of 1 it is faster than Embree's best.

n_scenes = words(scenes); n_kinds = words(kinds); n_accels = words(accels)
is_embree(a) = word(accels, a)[1:6] eq "embree"
shown = ""
do for [a = 1:n_accels] { if (!is_embree(a)) { shown = shown.sprintf("%d ", a) } }
n_shown = words(shown)
row(name) = sum [i = 1:n_shown] (word(accels, int(word(shown, i))) eq name ? n_shown + 1 - i : 0)
shift(s) = 0.7 / n_scenes * (0.5 * (n_scenes + 1) - s)
on(s, k) = strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) && row(strcol("accel")) > 0

columns = across(2, n_kinds); rows = (n_kinds + columns - 1) / columns
key_rows = paper eq "column" ? 2 : 1
height = 64 + 20 * key_rows + (70 + 30 * n_shown) * rows
set logscale x 2
set xrange [0.02 : 4]
eval "set xtics ".ratio_tics(0.02, 4)
set yrange [0.4 : n_shown + 0.6]
set grid ytics

eval canvas("1-arena", wide, height)
set multiplot layout rows, columns margins screen 168.0 / wide, 0.985, 60.0 / height, 1 - (56.0 + 20 * key_rows) / height spacing screen 0.03, 75.0 / height
do for [k = 1:n_kinds] {
  set title word(kinds, k) font ",14" textcolor rgb ink
  set ytics ()
  do for [i = 1:n_shown] { set ytics add ((k % columns == 1 % columns ? word(accels, int(word(shown, i))) : "") n_shown + 1 - i) }
  if (k == 1) {
    set key at screen 0.985, screen 1 - 8.0 / height right top vertical maxrows key_rows samplen 1 textcolor rgb ink
  } else { unset key }
  set arrow 1 from 1, graph 0 to 1, graph 1 nohead linewidth 1.5 dashtype 2 linecolor rgb soft
  plot for [s = 1:n_scenes] "times.csv" \
         using (on(s, k) ? column("ratio") : NaN):(row(strcol("accel")) + shift(s)):(column("ratio_low")):(column("ratio_high")) \
         with xerrorbars linewidth 1.4 pointtype mark(s) pointsize 0.6 linecolor rgb hue(s) title word(scenes, s)
}
unset multiplot
unset output
