# SPDX-License-Identifier: Apache-2.0
# overview: a performance profile, and the time of each accelerator over that of the fastest, scene by scene.
#: 1-profile: Part of the cells (a scene and a kind of rays) on which an accelerator takes at most tau times the time of the fastest
#:   there, over tau (Dolan & More 2002). At tau = 1 it is the part on which it is the fastest; the higher a curve, the better.
#: 2-scenes: Geometric mean, over the kinds of rays, of time over that of the fastest, by scene and accelerator.

n_scenes = words(scenes)
n_kinds = words(kinds)
place(list, text) = sum [i = 1:words(list)] (word(list, i) eq text ? i : 0)
cell(x) = (place(scenes, strcol("scene")) - 1) * n_kinds + place(kinds, strcol("kind"))
known(x) = place(accels, strcol("accel")) > 0 # not null runs
# The fastest of each cell by its throughput over the baseline's.
array best[n_scenes * n_kinds]
cells = 0
do for [c = 1:|best|] {
  stats "times.csv" using (known(0) && cell(0) == c ? column("ratio") : 0) nooutput
  best[c] = STATS_max > 0 ? STATS_max : NaN
  cells = cells + (STATS_max > 0)
}
tau(a) = place(accels, strcol("accel")) == a ? best[cell(0)] / column("ratio") : NaN

eval canvas("1-profile", 960, 460)
set logscale x
set grid xtics ytics
set xrange [1 : 1000]
set xtics (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
set yrange [0 : 100]
set ytics 20
set xlabel "tau: time over that of the fastest" textcolor rgb ink
set ylabel sprintf("cells within tau, %% of %d", cells) textcolor rgb ink
set key outside right center Left reverse samplen 2 textcolor rgb ink
plot for [a = 1:words(accels)] "times.csv" using (tau(a)):(100.0 / cells) smooth cumulative with steps linewidth 2 dashtype dash(a) \
  linecolor rgb color(a) title word(accels, a)
unset output

# Means over the kinds of a scene.
measured(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
eval canvas("2-scenes", 960, 520)
set xrange [*:*]
set yrange [*:*]
unset logscale
array mean[n_scenes * words(accels)]
do for [s = 1:n_scenes] { do for [a = 1:words(accels)] {
  stats "times.csv" using (measured(s, a) ? 1 : 0) nooutput; n = STATS_sum
  stats "times.csv" using (measured(s, a) ? log(tau(a)) : 0) nooutput
  mean[(s - 1) * words(accels) + a] = n > 0 ? exp(STATS_sum / n) : NaN
} }
set logscale x
set xrange [0.8 : 1000]
set yrange [n_scenes + 0.5 : 0.5]
unset ytics
set ytics scale 0
do for [s = 1:n_scenes] { set ytics add (word(scenes, s) s) }
unset ylabel
set xlabel "time over that of the fastest, mean of the kinds of rays" textcolor rgb ink
plot for [a = 1:words(accels)] "+" using (mean[int($0) * words(accels) + a]):(int($0) + 1) every ::0::n_scenes - 1 \
  with points pointtype marker(a) linewidth 1.5 linecolor rgb color(a) title word(accels, a)
unset output
