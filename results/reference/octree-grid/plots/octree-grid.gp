# SPDX-License-Identifier: Apache-2.0
# octree-grid: time of grid, nested grid and octree over the number of objects, the width of clusters and the ratio of the stadium.
#: 1-crossover: Time per ray of grid, nested grid, octree and, in the stadium, a deep octree, with intervals: over the number
#:   of evenly spread spheres, the width of clusters, and the length of the stadium over that of the teapot. All kinds of rays.

sweeps = "uniform clustered stadium"
keys = "scene.n scene.width scene.ratio"
captions = "'objects, evenly spread' 'width of clusters, of a cube of 2' 'length of the stadium / the teapot'"
# Kinds of rays are joined, weighted by the rays of each whole set.
row(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
set print "plots/1-crossover.csv"
print "sweep,x,accel,ns,low,high"
do for [s = 1:words(scenes)] {
  scene = word(scenes, s)
  sweep = scene[1:strstrt(scene, ":") - 1]
  x = real(scene[strstrt(scene, "=") + 1:*])
  do for [a = 1:words(accels)] {
    stats "times.csv" using (row(s, a) ? 1 : 0) nooutput
    if (STATS_max > 0) { # the accelerator was run on this scene
      stats "times.csv" using (row(s, a) ? weight(0) : NaN) nooutput; rays = STATS_sum
      stats "times.csv" using (row(s, a) ? weight(0) * column("ns") : NaN) nooutput; mean = STATS_sum / rays
      stats "times.csv" using (row(s, a) ? weight(0) * column("ns_low") : NaN) nooutput; low = STATS_sum / rays
      stats "times.csv" using (row(s, a) ? weight(0) * column("ns_high") : NaN) nooutput; high = STATS_sum / rays
      print sprintf("%s,%g,%s,%g,%g,%g", sweep, x, word(accels, a), mean, low, high)
    }
  }
}
unset print

eval canvas("1-crossover", 960, 400)
set multiplot layout 1, 3 margins screen 0.1, 0.985, 0.15, 0.88 spacing screen 0.02, 0.1
set logscale xy
set grid xtics ytics
stats "plots/1-crossover.csv" using (column("ns")) nooutput
set yrange [STATS_min / 1.4 : STATS_max * 1.4]
do for [p = 1:3] {
  set xlabel word(captions, p) textcolor rgb ink
  set title word(sweeps, p) font ",13" textcolor rgb ink
  set format x (p == 1 ? "10^{%T}" : "%h")
  set logscale x (p == 1 ? 10 : 2)
  set xtics auto
  if (p == 1) { set xrange [700 : 1.4e5] }
  if (p == 2) { set xrange [0.01 : 0.5]; set xtics (0.0125, 0.05, 0.2) }
  if (p == 3) { set xrange [35 : 36000]; set xtics (50, 400, 3200, 25600) }
  if (p == 1) { set ylabel "time, ns per ray" textcolor rgb ink; set key top left samplen 2 textcolor rgb ink } \
  else { unset ylabel; set format y ""; unset key }
  plot for [a = 1:words(accels)] "plots/1-crossover.csv" using (strcol("sweep") eq word(sweeps, p) && strcol("accel") eq word(accels, a) ? column("x") : NaN): \
    (column("ns")):(column("low")):(column("high")) with yerrorlines linewidth 1.8 dashtype dash(a) pointtype marker(a) pointsize 0.7 \
    linecolor rgb color(a) notitle, \
    for [a = 1:words(accels)] keyentry with linespoints linewidth 1.8 dashtype dash(a) pointtype marker(a) pointsize 0.7 \
    linecolor rgb color(a) title word(accels, a)
}
unset multiplot
unset output
