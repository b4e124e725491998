# SPDX-License-Identifier: Apache-2.0
# growth: build and traversal over the number of objects, with the exponents of fitted powers.
#: 1-build: Time to build each structure in nanoseconds per object, over the number of objects, with exponents of fitted powers of the time
#:   and with intervals. One panel for spheres, one for triangles.
#: 2-rays: Time per ray over the number of spheres, with exponents of fitted powers, for primary and random rays, with intervals.
#:   All exponents are listed in plots/exponents.csv.

families = "spheres soup"
own(f, a) = strcol("scene")[1:strlen(word(families, f)) + 1] eq word(families, f).":" && strcol("accel") eq word(accels, a) ? column("objects") : NaN
ray(f, a, k) = strcol("kind") eq word(kinds, k) ? own(f, a) : NaN
set fit quiet nolog errorvariables
power(x) = p + q * x
n_accels = words(accels); n_kinds = words(kinds)
array built[2 * n_accels]; array traced[n_accels * n_kinds]; array known[2 * n_accels]
set print "plots/exponents.csv"
print "scene,accel,what,exponent,standard_error"
do for [f = 1:2] { do for [a = 1:n_accels] {
  stats "times.csv" using (own(f, a) > 0 ? 1 : 0) nooutput
  known[(f - 1) * n_accels + a] = STATS_max
  if (STATS_max > 0) {
    p = -15; q = 1
    fit power(x) "times.csv" using (log(own(f, a))):(log(column("build_seconds"))) via p, q
    built[(f - 1) * n_accels + a] = q
    print sprintf("%s,%s,build,%.3f,%.3f", word(families, f), word(accels, a), q, q_err)
    do for [k = 1:n_kinds] {
      p = 4; q = 0.2
      fit power(x) "times.csv" using (log(ray(f, a, k))):(log(column("ns"))) via p, q
      if (f == 1) { traced[(a - 1) * n_kinds + k] = q }
      print sprintf("%s,%s,%s,%.3f,%.3f", word(families, f), word(accels, a), word(kinds, k), q, q_err)
    }
  }
} }
unset print

set logscale xy
set grid xtics ytics
set format x "10^{%T}"
set format y "10^{%T}"
set xrange [60 : 2e6]
set xlabel "objects" textcolor rgb ink
eval canvas("1-build", 960, 480)
set multiplot layout 1, 2 margins screen 0.08, 0.81, 0.13, 0.92 spacing screen 0.235, 0.1
side(a) = 1.05 ** (a - 0.5 * (n_accels + 2)) # intervals stand side by side
do for [f = 1:2] {
  set title word(families, f) font ",13" textcolor rgb ink
  set key at screen 0.335 + 0.4825 * (f - 1), screen 0.92 left top Left reverse textcolor rgb ink samplen 1.2 title "exponent" left
  if (f == 1) { set ylabel "time to build, ns per object" textcolor rgb ink } else { unset ylabel }
  # brute and extents only copy the list of objects: they are no structures
  plot for [a = 3:n_accels] "times.csv" using (known[(f - 1) * n_accels + a] > 0 ? own(f, a) * side(a) : NaN): \
      (column("build_seconds") / column("objects") * 1e9):(column("build_low") / column("objects") * 1e9): \
      (column("build_high") / column("objects") * 1e9) with yerrorlines linewidth 1.4 dashtype dash(a) pointtype marker(a) pointsize 0.7 \
    linecolor rgb color(a) title (known[(f - 1) * n_accels + a] > 0 ? sprintf("%.2f  %s", built[(f - 1) * n_accels + a], word(accels, a)) : "")
}
unset multiplot
unset output

eval canvas("2-rays", 960, 440)
set multiplot layout 1, n_kinds margins screen 0.08, 0.775, 0.15, 0.9 spacing screen 0.255, 0.1
set yrange [10 : 1e6]
do for [k = 1:n_kinds] {
  set title word(kinds, k)." rays" font ",13" textcolor rgb ink
  set key at screen 0.305 + 0.475 * (k - 1), screen 0.9 left top Left reverse samplen 1.2 spacing 0.95 textcolor rgb ink title "exponent" left
  if (k == 1) { set ylabel "time, ns per ray" textcolor rgb ink } else { unset ylabel }
  plot for [a = 1:n_accels] "times.csv" using (known[a] > 0 ? ray(1, a, k) : NaN):(column("ns")):(column("ns_low")):(column("ns_high")) \
    with yerrorlines linewidth 1.6 dashtype dash(a) pointtype marker(a) pointsize 0.6 linecolor rgb color(a) \
    title (known[a] > 0 ? sprintf("%.2f  %s", traced[(a - 1) * n_kinds + k], word(accels, a)) : "")
}
unset multiplot
unset output
