# SPDX-License-Identifier: Apache-2.0
# light-buffer: throughput of shadow rays over that of `wide` alone, and time to build, one line per choice of cells.
#: 1-light-buffer: Throughput of shadow rays over that of wide alone, and seconds to build, by scene, one marker per choice of cells.
#:   Medians with intervals; right of 1 the light buffer is faster. Times to build are on a logarithmic axis; one that was built
#:   once has no interval. The order in each scene, from top to bottom, is that of the legend.

n_scenes = words(scenes); n_accels = words(accels)
chosen(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
place(s, a) = n_scenes - s + 0.12 * (0.5 * (n_accels + 1) - a)

set yrange [-0.6 : n_scenes - 0.4]
set grid xtics ytics
set bars small

height = 140 + 62 * n_scenes
eval canvas("1-light-buffer", 960, height)
set multiplot layout 1, 2 margins screen 0.15, 0.985, 72.0 / height, 1 - 44.0 / height spacing screen 0.05, 0.1
set arrow 1 from 1, graph 0 to 1, graph 1 nohead linewidth 1.5 dashtype 2 linecolor rgb soft back
set xlabel "throughput / that of wide" textcolor rgb ink
set ytics ()
do for [s = 1:n_scenes] { set ytics add (word(scenes, s) n_scenes - s) }
set key at screen 0.985, screen 1 - 8.0 / height right top vertical maxrows 1 samplen 1 textcolor rgb ink
plot keyentry with points pointtype marker(1) pointsize 0.8 linecolor rgb color(1) title word(accels, 1), \
     for [a = 2:n_accels] for [s = 1:n_scenes] "times.csv" \
       using (chosen(s, a) ? column("ratio") : NaN):(place(s, a)):(column("ratio_low")):(column("ratio_high")) \
       with xerrorbars linewidth 1.5 pointtype marker(a) pointsize 0.8 linecolor rgb color(a) title (s == 1 ? word(accels, a) : "")
unset key
unset arrow 1
set logscale x
set ytics ()
do for [s = 1:n_scenes] { set ytics add ("" n_scenes - s) }
set xlabel "time to build, in seconds" textcolor rgb ink
plot for [a = 1:n_accels] for [s = 1:n_scenes] "times.csv" \
       using (chosen(s, a) ? column("build_seconds") : NaN):(place(s, a)):(column("build_low")):(column("build_high")) \
       with xerrorbars linewidth 1.5 pointtype marker(a) pointsize 0.8 linecolor rgb color(a) notitle
unset multiplot
unset output
