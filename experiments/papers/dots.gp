# SPDX-License-Identifier: Apache-2.0
# Experiments that compare some accelerators on several scenes: a row per scene and kind of rays, a point per accelerator.
#: 1-dots: Object tests per ray, and time or extent tests per ray, of each accelerator: a row per scene and kind of rays.
#:   Logarithmic axes; farther left is better.

n_kinds = words(kinds); n_accels = words(accels)
place(text, list) = sum [i = 1:words(list)] (word(list, i) eq text ? i : 0)
level(i) = (place(strcol("scene"), scenes) - 1) * (n_kinds + 1) + place(strcol("kind"), kinds)
lowest = words(scenes) * (n_kinds + 1)
named(a) = strcol("accel") eq word(accels, a)

timed = system("test -f times.csv && echo 1 || echo 0") eq "1"
table = timed ? "times.csv" : "counts.csv"
per_ray(name) = column(name) / column("rays")
second(i) = timed ? column("ns") : per_ray("extent_tests")
positive(x) = x > 0 ? x : NaN

eval canvas("1-dots", 960, 140 + 15 * lowest)
set multiplot
set logscale x
set yrange [lowest + 0.5 : 0]
unset ytics
set grid xtics
set format x "%g"
set tmargin at screen 1 - 40.0 / (140 + 15 * lowest); set bmargin at screen 85.0 / (140 + 15 * lowest)
do for [s = 1:words(scenes)] {
  do for [k = 1:n_kinds] {
    set label 100 + s * 10 + k word(scenes, s)." ".word(kinds, k) at screen 0.175, first (s - 1) * (n_kinds + 1) + k right \
      noenhanced font ",12" textcolor rgb ink
  }
}
do for [p = 1:2] {
  set lmargin at screen (p == 1 ? 0.19 : 0.61); set rmargin at screen (p == 1 ? 0.56 : 0.97)
  set title (p == 1 ? "object tests per ray" : timed ? "time, ns per ray" : "extent tests per ray") font ",13" textcolor rgb ink
  if (p == 1) {
    set key at screen 0.98, screen 0.01 right bottom vertical maxrows 3 samplen 1 font ",12" noenhanced textcolor rgb ink
  } else { unset key; unset label }
  plot for [a = 1:n_accels] table using (named(a) ? positive(p == 1 ? per_ray("object_tests") : second(0)) : NaN):(level(0)) \
         with points pointtype mark(a) pointsize 0.8 linecolor rgb hue(a) title word(accels, a)
}
unset multiplot
unset output
