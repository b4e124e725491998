# SPDX-License-Identifier: Apache-2.0
# recursion: rays and time of a frame over the depth of recursion, and what each level adds.
#: 1-depth: Rays of a frame by kind, milliseconds of a frame, and milliseconds that a level adds, over the depth of recursion.
#:   Times with intervals; the added time is a difference of medians.

names = "balls gears"
deepest = 6
row(name, kind, accel) = strcol("scene")[1:strlen(name) + 1] eq name."-" && strcol("kind") eq kind && strcol("accel") eq accel
cell_row(n, d, a) = strcol("scene") eq word(names, n)."-".d && strcol("accel") eq word(accels, a)
array ms[words(names) * deepest * words(accels)]
array low[|ms|]; array high[|ms|]
cell(n, d, a) = ((n - 1) * deepest + d - 1) * words(accels) + a
do for [n = 1:words(names)] { do for [d = 1:deepest] { do for [a = 1:words(accels)] {
  stats "times.csv" using (cell_row(n, d, a) ? weight(0) * column("ns") : NaN) nooutput; ms[cell(n, d, a)] = STATS_sum * 1e-6
  stats "times.csv" using (cell_row(n, d, a) ? weight(0) * column("ns_low") : NaN) nooutput; low[cell(n, d, a)] = STATS_sum * 1e-6
  stats "times.csv" using (cell_row(n, d, a) ? weight(0) * column("ns_high") : NaN) nooutput; high[cell(n, d, a)] = STATS_sum * 1e-6
} } }

eval canvas("1-depth", 960, 560)
set multiplot layout 2, 3 margins screen 0.075, 0.985, 0.1, 0.93 spacing screen 0.075, 0.13
set grid xtics ytics
set xrange [0.7 : deepest + 0.3]
set xtics 1, 1, deepest
set yrange [0 : *]
do for [n = 1:words(names)] {
  if (n == words(names)) { set xlabel "depth of recursion" textcolor rgb ink }
  name = word(names, n)
  set title name.": rays of a frame" font ",13" textcolor rgb ink
  set ylabel "thousand rays" textcolor rgb ink
  if (n == words(names)) { set key inside top left reverse Left samplen 1.5 textcolor rgb ink; set offsets 0, 0, graph 0.35, 0 } else { unset key }
  plot for [k = 1:words(kinds)] "times.csv" using (row(name, word(kinds, k), word(accels, 1)) ? column("depth") : NaN):(weight(0) / 1000.0) \
    with linespoints linewidth 1.8 pointtype mark(k) pointsize 0.8 linecolor rgb hue(k) title word(kinds, k)
  unset offsets
  set title name.": time of a frame" font ",13" textcolor rgb ink
  set ylabel "ms" textcolor rgb ink
  plot for [a = 1:words(accels)] "+" using (int($0) + 1):(ms[cell(n, int($0) + 1, a)]):(low[cell(n, int($0) + 1, a)]):(high[cell(n, int($0) + 1, a)]) \
    every ::0::deepest - 1 with yerrorlines linewidth 1.8 pointtype marker(a) linecolor rgb color(a) title word(accels, a)
  unset key
  set title name.": time that a level adds" font ",13" textcolor rgb ink
  plot for [a = 1:words(accels)] "+" using (int($0) + 1):(ms[cell(n, int($0) + 1, a)] - (int($0) == 0 ? 0 : ms[cell(n, int($0), a)])) \
    every ::0::deepest - 1 with linespoints linewidth 1.8 pointtype marker(a) linecolor rgb color(a) title word(accels, a)
}
unset multiplot
unset output
