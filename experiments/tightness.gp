# SPDX-License-Identifier: Apache-2.0
# tightness: what each kind of extent lets through, and the time per ray, against the number of plane sets.

n_scenes = words(scenes)
chosen(s) = strcol("scene") eq word(scenes, s)
labelled(s, name) = chosen(s) && strcol("accel") eq name
# The number of plane sets in a label such as slabs-7.
k_of(label) = label[1:6] eq "slabs-" ? real(label[7:*]) : NaN
others = "box sphere obb"
hue(i) = word("#222222 #c1543c #2f6f9f #3a8a4d", i)

# Of the box, the sphere and the oriented box, which have no k: object tests per object met, and the time.
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

eval svg("1-tightness", 120 + 370 * n_scenes, 660)
set multiplot layout 2, n_scenes columnsfirst margins screen 0.07, 0.985, 0.09, 0.84 spacing screen 0.06, 0.13
set grid ytics
set xtics 3, 2, 13
set xrange [2.5 : 13.5]
do for [s = 1:n_scenes] {
  set yrange [1 : *]
  set title word(scenes, s).": object tests per object met" font ",14" textcolor rgb ink
  unset xlabel
  if (s == 1) {
    set key at screen 0.985, screen 0.985 right top horizontal samplen 2 textcolor rgb ink
  } else { unset key }
  plot "counts.csv" using (chosen(s) ? k_of(strcol("accel")) : NaN):(column("object_tests") / column("object_hits")) \
         with linespoints linewidth 2 pointtype 7 linecolor rgb hue(4) title "k slabs", \
       for [i = 1:3] passed[3 * (s - 1) + i] with lines linewidth 1.5 linecolor rgb hue(i) title word(others, i)
  unset key
  set yrange [0 : *]
  set title word(scenes, s).": time per ray, that of boxes being 1" font ",14" textcolor rgb ink
  set xlabel "plane sets k" textcolor rgb ink
  plot "times.csv" using (chosen(s) ? k_of(strcol("accel")) : NaN):(1 / column("ratio")):(1 / column("ratio_high")):(1 / column("ratio_low")) \
         with yerrorlines linewidth 2 pointtype 7 linecolor rgb hue(4) notitle, \
       for [i = 1:3] taken[3 * (s - 1) + i] with lines linewidth 1.5 linecolor rgb hue(i) notitle
}
unset multiplot
unset output
