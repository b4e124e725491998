# SPDX-License-Identifier: Apache-2.0
# build-scaling: time to build per object, over the number of objects, with the exponents of fitted powers.
#: 1-build-scaling: Time to build each structure in nanoseconds per object, over the number of objects.
#:   Both axes logarithmic; the legend lists the lines in the order of their right ends, with the exponents of fitted powers.

n_accels = words(accels)
own(a) = strcol("accel") eq word(accels, a) ? column("objects") : NaN

set fit quiet nolog errorvariables
array exponent[n_accels]; array deviation[n_accels]
set print "plots/exponents.csv"
print "accel,exponent,standard_error"
power(x) = p + q * x
do for [a = 1:n_accels] {
  p = -15; q = 1
  fit power(x) "times.csv" using (log(own(a))):(log(column("build_seconds"))) via p, q
  exponent[a] = q; deviation[a] = q_err
  print sprintf("%s,%.3f,%.3f", word(accels, a), q, q_err)
}
unset print

array last[n_accels]
do for [a = 1:n_accels] {
  stats "times.csv" using (own(a)):(column("build_seconds") / column("objects")) nooutput
  most = STATS_max_x
  stats "times.csv" using (own(a) == most ? column("build_seconds") / column("objects") : NaN) nooutput
  last[a] = STATS_max
}
eval sort_last

eval canvas("1-build-scaling", 960, 560)
set logscale xy
set grid xtics ytics
set format x "10^{%T}"
set xlabel "objects" textcolor rgb ink
set ylabel "time to build, ns per object" textcolor rgb ink
set key outside right center Left reverse font ",12" textcolor rgb ink samplen 1.5 spacing 1.2 \
    title "time grows with objects to the power" left
set xrange [700 : 1.4e7]
plot for [i in order] a = int(i) "times.csv" using (own(a)):(column("build_seconds") / column("objects") * 1e9) \
       with linespoints linewidth 1.5 dashtype dash(a) pointtype marker(a) pointsize 0.7 linecolor rgb color(a) \
       title sprintf("%.3f ± %.3f  %s", exponent[a], deviation[a], word(accels, a))
unset output
