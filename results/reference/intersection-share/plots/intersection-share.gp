# SPDX-License-Identifier: Apache-2.0
# intersection-share: the part of a frame's time that is spent in queries of the accelerator.
#: 1-share: Part of the time of a frame that is spent on intersections, over the number of objects, with intervals; the band is
#:   Whitted's 75 to 95 %. On the right the same for three other scenes.

row(a) = strcol("accel") eq word(accels, a)
swept(a) = row(a) && strcol("scene")[1:7] eq "spheres" ? column("objects") : NaN
others = ""
do for [s = 1:words(scenes)] { if (word(scenes, s)[1:7] ne "spheres") { others = others." ".word(scenes, s) } }
place(x) = sum [i = 1:words(others)] (word(others, i) eq strcol("scene") ? i : 0)

eval canvas("1-share", 960, 400)
set multiplot layout 1, 2 margins screen 0.075, 0.985, 0.14, 0.88 spacing screen 0.05, 0.1
set grid xtics ytics
set yrange [0 : 100]
set ylabel "time on intersections, % of a frame" textcolor rgb ink
set object 1 rectangle from graph 0, first 75 to graph 1, first 95 behind fillcolor rgb faint fillstyle solid 0.6 noborder
set label 1 "Whitted 1980" at graph 0.02, first 92 textcolor rgb soft font ",11"
set logscale x
set format x "10^{%T}"
set xrange [6 : 2e5]
set xlabel "spheres" textcolor rgb ink
set key at screen 0.985, screen 0.985 right top vertical maxrows 1 samplen 2 textcolor rgb ink
plot for [a = 1:words(accels)] "render.csv" using (swept(a)):(100 * column("query_share")):(100 * column("query_share_low")): \
  (100 * column("query_share_high")) with yerrorlines linewidth 1.8 dashtype dash(a) pointtype marker(a) linecolor rgb color(a) title word(accels, a)
unset logscale x
unset key; unset label 1; unset ylabel
set xlabel " "
set xrange [0.5 : words(others) + 0.5]
set xtics scale 0 ("" 1)
do for [i = 1:words(others)] { set xtics add (word(others, i) i) }
plot for [a = 1:words(accels)] "render.csv" using (row(a) && place(0) > 0 ? place(0) + 0.1 * (a - 3.5) : NaN):(100 * column("query_share")): \
  (100 * column("query_share_low")):(100 * column("query_share_high")) with yerrorbars linewidth 1.8 pointtype marker(a) linecolor rgb color(a)
unset multiplot
unset output
