# SPDX-License-Identifier: Apache-2.0
# amortised: build and rays together, over the number of rays; and where each structure breaks even.
#: 1-total: Time for the build and for the rays together, over the number of rays, for each structure.
#:   The lowest line is the best choice for so many rays. The vertical line is a frame of 256 x 256 primary rays.
#: 2-break-even: Rays after which each structure has paid for its build, compared with no structure and with the grid, with intervals.
#:   No mark: never. All kinds of rays together. The intervals combine those of build and time at their worst.

named(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
index_of(label) = sum [a = 1:words(accels)] (word(accels, a) eq label ? a : 0)
n_cells = words(scenes) * words(accels)
cell(s, a) = (s - 1) * words(accels) + a
# Seconds to build and per ray: medians, and the ends of their intervals.
array build[n_cells]; array build_low[n_cells]; array build_high[n_cells]
array per_ray[n_cells]; array per_ray_low[n_cells]; array per_ray_high[n_cells]
do for [s = 1:words(scenes)] {
  do for [a = 1:words(accels)] {
    stats "times.csv" using (named(s, a) ? weight(0) : NaN) nooutput; rays = STATS_sum
    do for [end in "_low _high"] {
      stats "times.csv" using (named(s, a) ? column("build".end) : NaN) nooutput; seconds = STATS_mean
      eval sprintf("build%s[cell(s, a)] = seconds", end)
      stats "times.csv" using (named(s, a) ? weight(0) * column("ns".end) : NaN) nooutput; seconds = STATS_sum / rays * 1e-9
      eval sprintf("per_ray%s[cell(s, a)] = seconds", end)
    }
    stats "times.csv" using (named(s, a) ? column("build_seconds") : NaN) nooutput; build[cell(s, a)] = STATS_mean
    stats "times.csv" using (named(s, a) ? weight(0) * column("ns") : NaN) nooutput; per_ray[cell(s, a)] = STATS_sum / rays * 1e-9
  }
}

eval canvas("1-total", 960, 460)
set multiplot layout 1, words(scenes) margins screen 0.075, 0.985, 0.13, 0.77 spacing screen 0.02, 0.1
set logscale xy
set grid xtics ytics
set xrange [1 : 8e9]
set yrange [1e-4 : 1e3]
set xtics 1000
set format x "10^{%T}"
set format y "10^{%T}"
set xlabel "rays" textcolor rgb ink
set arrow from 65536, 1e-4 to 65536, 1e3 nohead dashtype 2 linecolor rgb soft
do for [s = 1:words(scenes)] {
  set title word(scenes, s) font ",13" textcolor rgb ink
  if (s == 1) {
    set ylabel "build and rays, seconds" textcolor rgb ink
    set key at screen 0.985, screen 0.985 right top vertical maxrows 2 samplen 2 textcolor rgb ink
  } else { unset ylabel; set format y ""; unset key }
  plot for [a = 1:words(accels)] build[cell(s, a)] + x * per_ray[cell(s, a)] with lines linewidth 1.6 dashtype dash(a) linecolor rgb color(a) title word(accels, a)
}
unset multiplot
unset output
unset arrow

never = 3e8
rays_saved(cost, saved) = saved <= 0 ? NaN : cost <= 0 ? 1 : cost / saved
even(s, a, other) = a == other ? NaN : \
  rays_saved(build[cell(s, a)] - build[cell(s, other)], per_ray[cell(s, other)] - per_ray[cell(s, a)])
soonest(s, a, other) = rays_saved(build_low[cell(s, a)] - build_high[cell(s, other)], per_ray_high[cell(s, other)] - per_ray_low[cell(s, a)])
latest(s, a, other) = (saved = per_ray_low[cell(s, other)] - per_ray_high[cell(s, a)], \
  saved <= 0 ? never : rays_saved(build_high[cell(s, a)] - build_low[cell(s, other)], saved))
set print "plots/2-break-even.csv"
print "scene,accel,build_ms,ns_per_ray,against_brute,against_grid"
do for [s = 1:words(scenes)] { do for [a = 1:words(accels)] {
  print sprintf("%s,%s,%.3f,%.1f,%.0f,%.0f", word(scenes, s), word(accels, a), build[cell(s, a)] * 1e3, per_ray[cell(s, a)] * 1e9, \
    even(s, a, index_of("brute")), even(s, a, index_of("grid")))
} }
unset print
eval canvas("2-break-even", 960, 400)
set multiplot layout 1, words(scenes) margins screen 0.11, 0.985, 0.15, 0.8 spacing screen 0.02, 0.1
set xtics 100
set format x "10^{%T}"
set xrange [1 : never]
set yrange [words(accels) + 0.5 : 2.5]
unset logscale y
set format y "%s"
set xlabel "rays until the build has paid" textcolor rgb ink
unset ylabel
do for [s = 1:words(scenes)] {
  set title word(scenes, s) font ",13" textcolor rgb ink
  unset ytics
  set ytics scale 0
  do for [a = 3:words(accels)] { set ytics add ((s == 1 ? word(accels, a) : "") a) }
  if (s == 1) { set key at screen 0.985, screen 0.985 right top vertical maxrows 1 samplen 1 textcolor rgb ink } else { unset key }
  plot for [i = 1:2] NaN with points pointtype mark(i) linecolor rgb hue(i) title "compared with ".word("brute grid", i), \
       for [i = 1:2] for [a = 3:words(accels)] "+" using (even(s, a, index_of(word("brute grid", i)))):(a): \
         (soonest(s, a, index_of(word("brute grid", i)))):(latest(s, a, index_of(word("brute grid", i)))) every ::0::0 \
         with xerrorbars pointtype mark(i) pointsize 0.8 linewidth 1.5 linecolor rgb hue(i) notitle
}
unset multiplot
unset output
