# SPDX-License-Identifier: Apache-2.0
# embree: throughput over that of Embree's best, by scene and ray kind.
#: 1-embree: Throughput of our hierarchies over that of Embree's best, by ray kind, one panel per scene.
#:   Medians with intervals where these are wider than the markers; above 1 ours is faster. All panels have one logarithmic scale.

n_scenes = words(scenes); n_kinds = words(kinds); n_accels = words(accels)
place(kind) = sum [k = 1:n_kinds] (word(kinds, k) eq kind ? k : 0)
own(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
is_embree(a) = word(accels, a)[1:6] eq "embree"

# Our own accelerators.
ours = ""
do for [a = 1:n_accels] { if (!is_embree(a)) { ours = ours.sprintf("%d ", a) } }
n_ours = words(ours)
is_ours(name) = sum [i = 1:n_ours] (word(accels, int(word(ours, i))) eq name)
stats "times.csv" using (is_ours(strcol("accel")) ? column("ratio_low") : NaN) nooutput
low = STATS_min / 1.15
stats "times.csv" using (is_ours(strcol("accel")) ? column("ratio_high") : NaN) nooutput
high = STATS_max * 1.15
shift(i) = 0.16 * (i - 0.5 * (n_ours + 1))

set xrange [0.5 : n_kinds + 0.5]
set xtics () rotate by 30 right
do for [k = 1:n_kinds] { set xtics add (word(kinds, k) k) }
set grid ytics

columns = across(3, n_scenes); rows = (n_scenes + columns - 1) / columns
height = 78 + 290 * rows
left = 76.0 / wide

set logscale y 2
eval "set ytics ".ratio_tics(low, high)

eval canvas("1-embree", wide, height)
set multiplot layout rows, columns margins screen left, 0.985, 78.0 / height, 1 - 72.0 / height spacing screen 0.045, 105.0 / height
set yrange [low : high]
do for [s = 1:n_scenes] {
  set title word(scenes, s) font ",14" textcolor rgb ink
  set ylabel (s % columns == 1 ? "throughput / Embree's best" : "") textcolor rgb ink
  if (s == 1) {
    set key at screen 0.985, screen 1 - 8.0 / height right top vertical maxrows 1 samplen 1 textcolor rgb ink
  } else { unset key }
  plot 1 with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
       for [i = 1:n_ours] a = int(word(ours, i)) "times.csv" \
         using (own(s, a) ? place(strcol("kind")) + shift(i) : NaN):(column("ratio")):(column("ratio_low")):(column("ratio_high")) \
         with yerrorbars linewidth 1.6 pointtype marker(a) pointsize 0.65 linecolor rgb color(a) title word(accels, a)
}
unset multiplot
unset output
