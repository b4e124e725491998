# SPDX-License-Identifier: Apache-2.0
# prediction: time per ray over the expected cost of the structure, a panel per kind of rays; and over what tests and steps cost.
#: 1-cost: Time per ray over the expected cost, both over the least of the scene and family, one panel per kind of rays.
#:   A color for each family of structures, a marker for each scene. Logarithmic axes; on the line they grow alike.
#: 2-time: Measured nanoseconds per ray, over those from times of a ray, a test and a step, one marker per scene.
#:   The times were fitted to the same family on the other scenes. Both axes logarithmic.

families = "bvh grid octree"
n_families = words(families); n_scenes = words(scenes); n_kinds = words(kinds)
of_family(f) = strcol("accel")[1:strlen(word(families, f)) + 1] eq word(families, f).":" && !strstrt(strcol("accel"), "(again)")
is(f, s, k) = strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) && of_family(f)
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
set xrange [0.9 : 40]
set yrange [0.9 : 40]
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

# ---- time from tests and steps: constants are fitted to the same family on the other scenes ----

other(s, f) = of_family(f) && strcol("scene") ne word(scenes, s)
own(s, f) = of_family(f) && strcol("scene") eq word(scenes, s)
per_ray(name) = column(name) / column("rays")
# Relative errors are least, with times that are not negative: Gauss-Seidel on the normal equations.
over_time(name, s, f) = other(s, f) ? (name eq "" ? 1 : per_ray(name)) / column("ns") : NaN
not_negative(x) = x > 0 ? x : 0
unset logscale; set autoscale # statistics leave out what lies beyond
array base_ns[n_scenes * n_families]; array test_ns[|base_ns|]; array step_ns[|base_ns|]
do for [s = 1:n_scenes] { do for [f = 1:n_families] {
  i = (s - 1) * n_families + f
  base_ns[i] = NaN
  stats "times.csv" using (own(s, f) && column("ns") > 0 ? 1 : 0) nooutput
  if (STATS_max > 0) {
    stats "times.csv" using (over_time("", s, f)):(over_time("object_tests", s, f)) nooutput
    one_one = STATS_sumsq_x; one_test = STATS_sumxy; one = STATS_sum_x
    stats "times.csv" using (over_time("", s, f)):(over_time("steps", s, f)) nooutput
    one_step = STATS_sumxy
    stats "times.csv" using (over_time("object_tests", s, f)):(over_time("steps", s, f)) nooutput
    p = 0; q = 0; r = 0
    do for [round = 1:1000] {
      p = not_negative((one - q * one_test - r * one_step) / one_one)
      q = not_negative((STATS_sum_x - p * one_test - r * STATS_sumxy) / STATS_sumsq_x)
      r = not_negative((STATS_sum_y - p * one_step - q * STATS_sumxy) / STATS_sumsq_y)
    }
    base_ns[i] = p; test_ns[i] = q; step_ns[i] = r
  }
} }

eval canvas("2-time", 960, 500)
set multiplot
set logscale xy
set grid xtics ytics
set format "10^{%T}"
set xrange [10 : 200000]; set yrange [10 : 200000]
set lmargin at screen 0.085; set rmargin at screen 0.51; set tmargin at screen 0.95; set bmargin at screen 0.12
set xlabel "ns per ray by times of a ray, a test and a step" textcolor rgb ink
set ylabel "ns per ray, measured" textcolor rgb ink
set key at screen 0.54, screen 0.95 left top vertical maxrows n_scenes Left reverse samplen 0.5 textcolor rgb ink
unset title
plot x with lines linecolor rgb soft notitle, \
     for [s = 1:n_scenes] NaN with points pointtype mark(s) pointsize 0.7 linecolor rgb hue(s) title word(scenes, s), \
     for [s = 1:n_scenes] for [f = 1:n_families] "times.csv" using (own(s, f) ? (i = (s - 1) * n_families + f, \
         base_ns[i] + test_ns[i] * per_ray("object_tests") + step_ns[i] * per_ray("steps")) : NaN):(column("ns")) \
       with points pointtype mark(s) pointsize 0.55 linecolor rgb hue(s) notitle
unset multiplot
set format "%g"
unset key
unset output
