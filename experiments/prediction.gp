# SPDX-License-Identifier: Apache-2.0
# prediction: time per ray over the expected cost of the structure, a panel per kind of rays.
#: 1-cost: Time per ray over the expected cost, both over the least of the scene and family, one panel per kind of rays.
#:   A color for each family of structures, a marker for each scene. Logarithmic axes; on the line they grow alike.

families = "bvh grid octree"
n_families = words(families); n_scenes = words(scenes); n_kinds = words(kinds)
is(f, s, k) = strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) && \
              strcol("accel")[1:strlen(word(families, f)) + 1] eq word(families, f).":" && !strstrt(strcol("accel"), "(again)")
array least_cost[n_families * n_scenes * n_kinds]; array least_time[|least_cost|]
cell(f, s, k) = ((f - 1) * n_scenes + s - 1) * n_kinds + k
do for [f = 1:n_families] { do for [s = 1:n_scenes] { do for [k = 1:n_kinds] {
  least_cost[cell(f, s, k)] = NaN; least_time[cell(f, s, k)] = NaN
  stats "times.csv" using (is(f, s, k) ? 1 : 0) nooutput
  if (STATS_max > 0) {
    stats "times.csv" using (is(f, s, k) ? column("predicted_cost") : NaN):(column("ns")) nooutput
    least_cost[cell(f, s, k)] = STATS_min_x; least_time[cell(f, s, k)] = STATS_min_y
  }
} } }

eval canvas("1-cost", 960, 420)
set multiplot layout 1, n_kinds margins screen 0.075, 0.985, 0.14, 0.72 spacing screen 0.02, 0.1
set logscale xy
set grid xtics ytics
set xrange [0.9 : 200]
set yrange [0.9 : 200]
set xlabel "cost / the least" textcolor rgb ink
do for [k = 1:n_kinds] {
  set title word(kinds, k) font ",13" textcolor rgb ink
  if (k == 1) {
    set ylabel "time / the least" textcolor rgb ink
    set key at screen 0.985, screen 0.985 right top vertical maxrows 3 samplen 1 textcolor rgb ink
  } else { unset ylabel; set format y ""; unset key }
  plot x with lines linewidth 0.7 linecolor rgb soft notitle, \
       for [f = 1:n_families] NaN with points pointtype 7 linecolor rgb hue(f) title word(families, f), \
       for [s = 1:n_scenes] NaN with points pointtype mark(s) linecolor rgb soft title word(scenes, s), \
       for [f = 1:n_families] for [s = 1:n_scenes] "times.csv" using (is(f, s, k) ? column("predicted_cost") / least_cost[cell(f, s, k)] : NaN): \
         (column("ns") / least_time[cell(f, s, k)]) with points pointtype mark(s) pointsize 0.6 linecolor rgb hue(f) notitle
}
unset multiplot
unset output
