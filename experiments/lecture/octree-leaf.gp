# SPDX-License-Identifier: Apache-2.0
# octree-leaf: time over the most objects per leaf and over the largest depth of an octree.
#: 1-leaf: Time per ray over the most objects of an octant that is not divided, for each kind of rays, with intervals.
#: 2-depth-of-2: Time per ray over the largest depth, leaves of two objects, for each kind of rays, with intervals.
#: 3-depth-of-16: The same with leaves of sixteen.

row(s, k, name) = strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) && measured(name)
measured(name) = strcol("accel")[1:strlen(name) + 1] eq name.":" && strstrt(strcol("accel"), "(again)") == 0
names = "leaf depth:max_leaf_size=2 depth:max_leaf_size=16"
files = "leaf depth-of-2 depth-of-16"
columns = "accel.max_leaf_size accel.max_depth accel.max_depth"
captions = "'leaf size' 'depth' 'depth'"
set grid xtics ytics
do for [p = 1:3] {
  name = word(names, p); by = word(columns, p)
  unset logscale y
  set xrange [*:*]
  set yrange [*:*]
  stats "times.csv" using (measured(name) ? column("ns") : NaN) nooutput
  set logscale y 10
  set format y "%h"
  set yrange [STATS_min / 1.3 : STATS_max * 1.3]
  if (p == 1) { set logscale x 2; set xrange [0.8 : 40]; set xtics (1, 4, 16) } \
  else { unset logscale x; set xrange [3.7 : 10.3]; set xtics 4, 2, 10 }
  eval canvas(sprintf("%d-%s", p, word(files, p)), 960, 380)
  set multiplot layout 1, words(scenes) margins screen 0.095, 0.985, 0.16, 0.8 spacing screen 0.02, 0.1
  set xlabel word(captions, p) textcolor rgb ink
  do for [s = 1:words(scenes)] {
    set title word(scenes, s) font ",13" textcolor rgb ink
    if (s == 1) {
      set ylabel "time, ns per ray" textcolor rgb ink
      set key at screen 0.985, screen 0.985 right top vertical maxrows 1 samplen 2 textcolor rgb ink
    } else { unset ylabel; set format y ""; unset key }
    plot for [k = 1:words(kinds)] "times.csv" using (row(s, k, name) ? column(by) : NaN):(column("ns")):(column("ns_low")): \
      (column("ns_high")) with yerrorlines linewidth 1.8 dashtype k pointtype mark(k) pointsize 0.7 linecolor rgb hue(k) title word(kinds, k)
  }
  unset multiplot
  unset output
}
