# SPDX-License-Identifier: Apache-2.0
# Experiments about the growth of build times: a line per accelerator over the number of objects.
#: 1-builds: Time to build each structure in nanoseconds per object, over the number of objects: medians with intervals.
#:   The legend lists the exponents of fitted powers of the time, with their standard errors.

own(a) = strcol("accel") eq word(accels, a) ? column("objects") : NaN
each(name) = column(name) / column("objects") * 1e9
set fit quiet nolog errorvariables
power(x) = p + q * x
array exponent[words(accels)]; array deviation[words(accels)]
do for [a = 1:words(accels)] {
  p = -15; q = 1
  fit power(x) "times.csv" using (log(own(a))):(log(column("build_seconds"))) via p, q
  exponent[a] = q; deviation[a] = q_err
}

eval canvas("1-builds", 960, 420)
set logscale xy
set grid xtics ytics
set format x "10^{%T}"
set xlabel "objects" textcolor rgb ink
set ylabel "time to build, ns per object" textcolor rgb ink
set key outside right center Left reverse noenhanced textcolor rgb ink samplen 1.5 spacing 1.2 title "exponent" left
plot for [a = 1:words(accels)] "times.csv" using (own(a)):(each("build_seconds")):(each("build_low")):(each("build_high")) \
  with yerrorlines linewidth 1.5 dashtype dash(a) pointtype marker(a) pointsize 0.7 linecolor rgb color(a) \
  title sprintf("%.2f ± %.2f  %s", exponent[a], deviation[a], word(accels, a))
unset output
