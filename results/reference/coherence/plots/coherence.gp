# SPDX-License-Identifier: Apache-2.0
# coherence: time, tests and steps of each kind of rays.
#: 1-kinds: Time per ray of each kind, with intervals, and below it the steps and object tests of bvh.
#:   wide traces packets and many rays at once; in-flight has no packets; one-ray traces one ray after the other.

row(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
kind_of(x) = sum [k = 1:words(kinds)] (word(kinds, k) eq strcol("kind") ? k : 0)
look(a) = hue(a)

eval canvas("1-kinds", 960, 600)
set multiplot layout 2, words(scenes) columnsfirst margins screen 0.075, 0.985, 0.17, 0.87 spacing screen 0.02, 0.06
set logscale y
set grid xtics ytics
set xrange [0.5 : words(kinds) + 0.5]
stats "times.csv" using (column("ns")) nooutput
lowest = STATS_min / 1.4; highest = STATS_max * 1.4
do for [s = 1:words(scenes)] {
  set title word(scenes, s) font ",13" textcolor rgb ink
  set yrange [lowest : highest]
  set xtics rotate by 0
  do for [k = 1:words(kinds)] { set xtics add ("" k) }
  set format y (s == 1 ? "%h" : "")
  if (s == 1) {
    set ylabel "time, ns per ray" textcolor rgb ink
    set key at screen 0.985, screen 0.985 right top vertical maxrows 1 samplen 1.5 textcolor rgb ink
  } else { unset ylabel; unset key }
  plot for [a = 1:words(accels)] "times.csv" using (row(s, a) ? kind_of(0) + 0.08 * (a - 4) : NaN):(column("ns")):(column("ns_low")):(column("ns_high")) \
    with yerrorbars linewidth 1.5 pointtype mark(a) pointsize 0.8 linecolor rgb look(a) title word(accels, a)
  unset title
  set yrange [0.1 : 300]
  set xtics rotate by 45 right
  do for [k = 1:words(kinds)] { set xtics add (word(kinds, k) k) }
  if (s == 1) {
    set ylabel "bvh, per ray" textcolor rgb ink
    set key inside top right horizontal samplen 1 textcolor rgb ink
  } else { unset key }
  bvh = 4
  plot "counts.csv" using (row(s, bvh) ? kind_of(0) : NaN):(column("steps") / column("rays")) with points pointtype 7 linecolor rgb hue(6) title "steps", \
       "counts.csv" using (row(s, bvh) ? kind_of(0) : NaN):(column("object_tests") / column("rays")) with points pointtype 6 linewidth 1.5 linecolor rgb hue(2) title "object tests"
}
unset multiplot
unset output
