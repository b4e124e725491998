# SPDX-License-Identifier: Apache-2.0
# tightness: object tests per object hit of each kind of extent, and the time per ray, against the number of plane sets.
#: 1-tightness: Object tests per object hit, and time per ray, over the number of plane sets k of slabs, with box, sphere and
#:   oriented box as level lines, for primary rays. Above: 1 is tight. Below: time over that of three sets, with intervals.

all_scenes = scenes
scenes = "balls jewel bunny"
n_scenes = words(scenes)
chosen(s) = strcol("scene") eq word(scenes, s) && strcol("kind") eq "primary"
labelled(s, name) = chosen(s) && strcol("accel") eq name
# The number of plane sets in a label such as slabs-7.
k_of(label) = label[1:6] eq "slabs-" && !strstrt(label, "(again)") ? real(label[7:*]) : NaN
others = "box sphere obb"

# For the box, the sphere and the oriented box, which have no k: object tests per object hit, and the time.
array passed[3 * n_scenes]
array taken[3 * n_scenes]
do for [s = 1:n_scenes] {
  do for [i = 1:3] {
    stats "counts.csv" using (labelled(s, word(others, i)) ? column("object_tests") / column("object_hits") : NaN) nooutput
    passed[3 * (s - 1) + i] = STATS_mean
    stats "times.csv" using (labelled(s, word(others, i)) ? 1 / column("ratio") : NaN) nooutput
    taken[3 * (s - 1) + i] = STATS_mean
  }
}

eval canvas("1-tightness", 960, 640)
set multiplot layout 2, n_scenes columnsfirst margins screen 0.05, 0.985, 0.09, 0.87 spacing screen 0.045, 0.13
set grid ytics
set xtics 3, 2, 13
set xrange [2.5 : 13.5]
do for [s = 1:n_scenes] {
  set yrange [0.9 : *]
  set title word(scenes, s).": tests per object hit" textcolor rgb ink
  unset xlabel
  if (s == 1) {
    set key at screen 0.985, screen 0.985 right top vertical maxrows 1 samplen 2 textcolor rgb ink
  } else { unset key }
  plot "counts.csv" using (chosen(s) ? k_of(strcol("accel")) : NaN):(column("object_tests") / column("object_hits")) \
         with linespoints linewidth 1.8 pointtype 7 pointsize 0.7 linecolor rgb hue(4) title "k slabs", \
       for [i = 1:3] passed[3 * (s - 1) + i] with lines linewidth 1.5 dashtype 1 + i linecolor rgb hue(i) title word(others, i)
  unset key
  set yrange [0 : *]
  set title word(scenes, s).": time, three sets being 1" textcolor rgb ink
  set xlabel "plane sets k" textcolor rgb ink
  plot "times.csv" using (chosen(s) ? k_of(strcol("accel")) : NaN):(1 / column("ratio")):(1 / column("ratio_high")):(1 / column("ratio_low")) \
         with yerrorlines linewidth 1.8 pointtype 7 pointsize 0.7 linecolor rgb hue(4) notitle, \
       for [i = 1:3] taken[3 * (s - 1) + i] with lines linewidth 1.5 dashtype 1 + i linecolor rgb hue(i) notitle
}
unset multiplot
unset output
scenes = all_scenes
