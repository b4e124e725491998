# SPDX-License-Identifier: Apache-2.0
# clustering: time per ray over the time to build, of each method; and time over expected cost.
#: 1-cost: Time per ray over build time, for each method of clustering and kind of rays, with intervals.
#:   To the lower left is better.
#: 2-expected: Time per random ray over the expected cost of the tree, with intervals. Both axes are logarithmic.

method(a) = word(accels, a)[17:*]
row(s, k, a) = strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) && strcol("accel") eq word(accels, a)

eval canvas("1-cost", 960, 480)
set multiplot layout 1, words(scenes) margins screen 0.095, 0.985, 0.15, 0.76 spacing screen 0.02, 0.1
set logscale xy
set grid xtics ytics
stats "times.csv" using (column("build_seconds") * 1000):(column("ns")) nooutput
set xrange [STATS_min_x / 1.7 : STATS_max_x * 1.7]
set yrange [STATS_min_y / 1.3 : STATS_max_y * 1.3]
set xlabel "build, ms" textcolor rgb ink
do for [s = 1:words(scenes)] {
  set title word(scenes, s) font ",13" textcolor rgb ink
  if (s == 1) {
    set ylabel "time, ns per ray" textcolor rgb ink
    set key at screen 0.985, screen 0.985 right top vertical maxrows 2 samplen 1.5 textcolor rgb ink
  } else { unset ylabel; set format y ""; unset key }
  plot for [a = 1:words(accels)] NaN with points pointtype 7 linecolor rgb hue(a) title method(a), \
       for [i = 1:words(accels) % 2] keyentry title " ", \
       for [k = 1:words(kinds)] NaN with points pointtype mark(k) linecolor rgb soft title word(kinds, k), \
       for [a = 1:words(accels)] for [k = 1:words(kinds)] "times.csv" using (row(s, k, a) ? column("build_seconds") * 1000 : NaN): \
         (column("ns")):(column("ns_low")):(column("ns_high")) with yerrorbars pointtype mark(k) pointsize 0.8 linewidth 1.5 linecolor rgb hue(a) notitle
}
unset multiplot
unset output

random = 0
do for [k = 1:words(kinds)] { if (word(kinds, k) eq "random") { random = k } }
eval canvas("2-expected", 480, 400)
unset title
set format y "%h"
set xrange [1 : 400]
set yrange [15 : 2000]
set xlabel "expected cost, steps of a random line" textcolor rgb ink
set ylabel "time, ns per random ray" textcolor rgb ink
set key inside bottom right reverse Left vertical maxrows 9 samplen 1 textcolor rgb ink
plot for [a = 1:words(accels)] NaN with points pointtype 7 linecolor rgb hue(a) title method(a), \
     for [s = 1:words(scenes)] NaN with points pointtype mark(s) linecolor rgb soft title word(scenes, s), \
     for [a = 1:words(accels)] for [s = 1:words(scenes)] "times.csv" using (row(s, random, a) ? column("predicted_cost") : NaN):(column("ns")): \
       (column("ns_low")):(column("ns_high")) with yerrorbars pointtype mark(s) pointsize 0.8 linewidth 1.5 linecolor rgb hue(a) notitle
unset output
