# SPDX-License-Identifier: Apache-2.0
# Experiments that sweep one parameter of an accelerator over several scenes: a line per scene.
#: 1-curves: Object tests per ray, and time over that of the baseline, over the swept parameter: a line per scene, a column per
#:   kind of rays. Below, a value under 1 is faster than the baseline; bars are intervals.

n_scenes = words(scenes); n_kinds = words(kinds)
# The value in a label such as slabs:slabs=3; NaN for accelerators that are not swept, and for the null run.
swept(label) = strstrt(label, "=") && !strstrt(label, "(again)") ? real(label[strstrt(label, "=") + 1:*]) : NaN
dashed(s) = s > 8 ? 2 : 1
row(s, k) = strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) ? swept(strcol("accel")) : NaN

stats "times.csv" using (swept(strcol("accel"))) nooutput
if (STATS_max / STATS_min > 4) { set logscale x; set xrange [STATS_min / 1.2 : STATS_max * 1.2] }
else { set xrange [STATS_min - 0.2 : STATS_max + 0.2] }
set xtics ()
do for [label in accels] {
  x = swept(label)
  if (x == x) { set xtics add (sprintf("%g", x) x); parameter = label[strstrt(label, ":") + 1:strstrt(label, "=") - 1] }
}
tests(i) = column("object_tests") / column("rays")
stats "times.csv" using (swept(strcol("accel")) > 0 && column("object_tests") > 0 ? tests(0) : NaN) nooutput
least = STATS_min / 1.3; most = STATS_max * 1.3
stats "times.csv" using (swept(strcol("accel")) > 0 ? 1 / column("ratio") : NaN) nooutput
fastest = STATS_min > 0.6 ? 0.45 : STATS_min / 1.3; slowest = STATS_max < 1.7 ? 2.2 : STATS_max * 1.3
longest = 0
do for [scene in scenes] { if (strlen(scene) > longest) { longest = strlen(scene) } }
right = 1 - (46 + 8.5 * longest) / 960

eval canvas("1-curves", 960, 640)
set multiplot layout 2, n_kinds margins screen 0.095, right, 0.125, 0.94 spacing screen 0.03, 0.1
set logscale y 2
set grid xtics ytics
do for [k = 1:n_kinds] {
  if (k == 1) { set ylabel "object tests per ray" textcolor rgb ink; set format y "%g" } else { unset ylabel; set format y "" }
  set title word(kinds, k) font ",13" textcolor rgb ink
  if (k < n_kinds) { unset key }
  else { set key at screen 0.99, screen 0.94 right top vertical maxcols 1 samplen 1.5 spacing 0.95 noenhanced textcolor rgb ink }
  set yrange [least : most]
  plot for [s = 1:n_scenes] "times.csv" using (row(s, k)):(tests(0)) with linespoints linewidth 1.5 \
         dashtype dashed(s) pointtype mark(s) pointsize 0.6 linecolor rgb hue(s) title word(scenes, s)
}
unset key
unset title
set xlabel parameter noenhanced textcolor rgb ink
do for [k = 1:n_kinds] {
  if (k == 1) { set ylabel "time over that of the baseline" textcolor rgb ink; set format y "%g" } else { unset ylabel; set format y "" }
  set yrange [fastest : slowest]
  plot 1 with lines linewidth 0.7 linecolor rgb soft, \
       for [s = 1:n_scenes] "times.csv" using (row(s, k)):(1 / column("ratio")): \
         (1 / column("ratio_high")):(1 / column("ratio_low")) with yerrorlines linewidth 1.5 dashtype dashed(s) \
         pointtype mark(s) pointsize 0.6 linecolor rgb hue(s)
}
unset multiplot
unset output
