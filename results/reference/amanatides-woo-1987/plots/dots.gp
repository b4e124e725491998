# SPDX-License-Identifier: Apache-2.0
# Experiments that compare some accelerators on several scenes: a row per scene and kind of rays, a point per accelerator.
#: 1-dots: Object tests per ray, and time or extent tests per ray, of each accelerator: a row per scene and kind of rays.
#:   Logarithmic axes; farther left is better. Times are medians with intervals.

n_kinds = words(kinds); n_accels = words(accels); n_scenes = words(scenes)
place(text, list) = sum [i = 1:words(list)] (word(list, i) eq text ? i : 0)
named(a) = strcol("accel") eq word(accels, a)
timed = system("test -f times.csv && echo 1 || echo 0") eq "1"
table = timed ? "times.csv" : "counts.csv"

# The heights of the rows, without kinds of rays that a scene has none of; half a row between scenes.
array level[n_scenes * n_kinds]
lowest = 0
do for [s = 1:n_scenes] {
  if (s > 1) { lowest = lowest + 0.5 }
  do for [k = 1:n_kinds] {
    stats table using (strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) ? 1 : 0) nooutput
    if (STATS_max > 0) { lowest = lowest + 1; level[(s - 1) * n_kinds + k] = lowest } else { level[(s - 1) * n_kinds + k] = NaN }
  }
}
at(a) = level[(place(strcol("scene"), scenes) - 1) * n_kinds + place(strcol("kind"), kinds)] + \
        0.7 / n_accels * (a - 0.5 * (n_accels + 1))
per_ray(name) = column(name) / column("rays")
tests(a) = named(a) && column("object_tests") > 0 ? per_ray("object_tests") : NaN
if (timed) { stats table using (column("ns")) nooutput; fastest = STATS_min; slowest = STATS_max }
extents(a) = named(a) && column("extent_tests") > 0 ? per_ray("extent_tests") : NaN

longest = 0
do for [label in accels] { if (strlen(label) > longest) { longest = strlen(label) } }
key_rows = (n_accels - 1) / int(940 / (42 + 7.2 * longest)) + 1
head = 50.0 + 20 * key_rows
height = head + 40 + (12 + 5 * n_accels) * lowest
eval canvas("1-dots", 960, height)
set multiplot layout 1, 2 margins screen 0.19, 0.975, 34.0 / height, 1 - head / height spacing screen 0.04, 0
set logscale x
set yrange [lowest + 0.6 : 0.4]
set ytics ()
do for [i = 1:|level|] {
  if (level[i] == level[i]) { set ytics add (word(scenes, (i - 1) / n_kinds + 1).", ".word(kinds, (i - 1) % n_kinds + 1) level[i]) }
}
set ytics noenhanced font ",12"
set grid xtics ytics
set format x "%g"
set title "object tests per ray" font ",14" textcolor rgb ink
set key at screen 0.985, screen 1 - 6.0 / height right top vertical maxrows key_rows samplen 1 noenhanced textcolor rgb ink
plot for [a = 1:n_accels] table using (tests(a)):(at(a)) \
       with points pointtype mark(a) pointsize 0.7 linecolor rgb hue(a) title word(accels, a)
unset key
do for [i = 1:|level|] { if (level[i] == level[i]) { set ytics add ("" level[i]) } }
set title (timed ? "time, ns per ray" : "extent tests per ray") font ",14" textcolor rgb ink
if (timed) {
  set xrange [fastest / 1.2 : slowest * 1.2]
  if (slowest / fastest < 20) { # one decade has too few labels
    set xtics ()
    do for [e = 0:7] { do for [m in "1 2 5"] { set xtics add (sprintf("%g", m * 10 ** e) m * 10 ** e) } }
  }
  plot for [a = 1:n_accels] table using (named(a) ? column("ns") : NaN):(at(a)):(column("ns_low")):(column("ns_high")) \
         with xerrorbars linewidth 1.4 pointtype mark(a) pointsize 0.7 linecolor rgb hue(a)
} else {
  plot for [a = 1:n_accels] table using (extents(a)):(at(a)) with points pointtype mark(a) pointsize 0.7 linecolor rgb hue(a)
}
unset multiplot
unset output
