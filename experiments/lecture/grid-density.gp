# SPDX-License-Identifier: Apache-2.0
# grid-density: time per ray over the density of a grid, and the model of Cleary & Wyvill.
#: 1-density: Time per ray over the density of the grid, for each kind of rays, with intervals. The black line without points is
#:   the model of Cleary & Wyvill, scaled to the time of random rays at density 1. Some of the scenes.

all_scenes = scenes
scenes = "uniform:n=10000 clustered bunny tree stadium"

labels = "grid no-mailbox"
row(s, k, label) = strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) && measured(label)
measured(label) = strcol("accel")[1:strlen(label) + 1] eq label.":" && strstrt(strcol("accel"), "(again)") == 0
model(x) = 14 * x + 5.7 * (1 + x / 2.0) ** 3 / x ** 2
random = 0
do for [k = 1:words(kinds)] { if (word(kinds, k) eq "random") { random = k } }

eval canvas("1-density", 960, 420)
set multiplot layout 1, words(scenes) margins screen 0.1, 0.985, 0.15, 0.74 spacing screen 0.02, 0.1
set logscale x 2
set logscale y 10
set grid xtics ytics
stats "times.csv" using (column("ns")) nooutput
set yrange [STATS_min / 1.3 : STATS_max * 1.3]
set xrange [0.18 : 90]
set xtics ("1/4" 0.25, "1" 1, "4" 4, "16" 16, "64" 64)
set xlabel "voxels per object" textcolor rgb ink
do for [s = 1:words(scenes)] {
  set title word(scenes, s) font ",13" textcolor rgb ink
  if (s == 1) {
    set ylabel "time, ns per ray" textcolor rgb ink
    set key at screen 0.985, screen 0.985 right top vertical maxrows 3 samplen 2 textcolor rgb ink
  } else { unset ylabel; set format y ""; unset key }
  stats "times.csv" using (row(s, random, "no-mailbox") && column("accel.density") == 1 ? column("ns") : NaN) nooutput
  scale = STATS_mean / model(1)
  plot for [i = 1:2] for [k = 1:words(kinds)] "times.csv" using (row(s, k, word(labels, i)) ? column("accel.density") : NaN): \
         (column("ns")):(column("ns_low")):(column("ns_high")) with yerrorlines linewidth 1.5 dashtype i pointtype (i == 1 ? mark(k) : mark(k + 5)) \
         pointsize 0.6 linecolor rgb hue(k) title word(kinds, k).(i == 1 ? "" : ", no mailbox"), \
       scale * model(x ** (1.0 / 3)) with lines linewidth 2.5 dashtype 4 linecolor rgb ink title "model"
}
unset multiplot
unset output
scenes = all_scenes
