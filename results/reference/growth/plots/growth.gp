# SPDX-License-Identifier: Apache-2.0
# growth: build and traversal over the number of objects, with the exponents of fitted powers.
#: 1-build: Time to build each structure in nanoseconds per object, over the number of objects, with exponents of fitted powers of the time
#:   and with intervals.
#: 2-rays: Time per ray over the number of objects, with exponents of fitted powers, for primary and random rays, with intervals.
#:   All exponents are listed in plots/exponents.csv.

own(a) = strcol("accel") eq word(accels, a) ? column("objects") : NaN
ray(a, k) = strcol("kind") eq word(kinds, k) ? own(a) : NaN
set fit quiet nolog errorvariables
power(x) = p + q * x
array built[words(accels)]; array traced[words(accels) * words(kinds)]
set print "plots/exponents.csv"
print "accel,what,exponent,standard_error"
do for [a = 1:words(accels)] {
  p = -15; q = 1
  fit power(x) "times.csv" using (log(own(a))):(log(column("build_seconds"))) via p, q
  built[a] = q
  print sprintf("%s,build,%.3f,%.3f", word(accels, a), q, q_err)
  do for [k = 1:words(kinds)] {
    p = 4; q = 0.2
    fit power(x) "times.csv" using (log(ray(a, k))):(log(column("ns"))) via p, q
    traced[(a - 1) * words(kinds) + k] = q
    print sprintf("%s,%s,%.3f,%.3f", word(accels, a), word(kinds, k), q, q_err)
  }
}
unset print

set logscale xy
set grid xtics ytics
set format x "10^{%T}"
set format y "10^{%T}"
set xrange [60 : 2e7]
set xlabel "objects" textcolor rgb ink
eval canvas("1-build", 960, 480)
set ylabel "time to build, ns per object" textcolor rgb ink
set key outside right center Left reverse textcolor rgb ink samplen 1.5 spacing 1.2 title "exponent" left
# brute and extents only copy the list of objects: they are no structures
side(a) = 1.05 ** (a - 0.5 * (words(accels) + 3)) # intervals stand side by side
plot for [a = 3:words(accels)] "times.csv" using (own(a) * side(a)):(column("build_seconds") / column("objects") * 1e9): \
    (column("build_low") / column("objects") * 1e9):(column("build_high") / column("objects") * 1e9) \
  with yerrorlines linewidth 1.4 dashtype dash(a) pointtype marker(a) pointsize 0.7 linecolor rgb color(a) title sprintf("%.2f  %s", built[a], word(accels, a))
unset output

eval canvas("2-rays", 960, 440)
set multiplot layout 1, words(kinds) margins screen 0.08, 0.775, 0.15, 0.9 spacing screen 0.255, 0.1
set yrange [10 : 1e6]
do for [k = 1:words(kinds)] {
  set title word(kinds, k)." rays" font ",13" textcolor rgb ink
  set key at screen 0.305 + 0.475 * (k - 1), screen 0.9 left top Left reverse samplen 1.2 spacing 0.95 textcolor rgb ink title "exponent" left
  if (k == 1) { set ylabel "time, ns per ray" textcolor rgb ink } else { unset ylabel }
  plot for [a = 1:words(accels)] "times.csv" using (ray(a, k)):(column("ns")):(column("ns_low")):(column("ns_high")) \
    with yerrorlines linewidth 1.6 dashtype dash(a) pointtype marker(a) pointsize 0.6 linecolor rgb color(a) \
    title sprintf("%.2f  %s", traced[(a - 1) * words(kinds) + k], word(accels, a))
}
unset multiplot
unset output
