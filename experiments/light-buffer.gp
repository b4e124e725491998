# SPDX-License-Identifier: Apache-2.0
# light-buffer: throughput of shadow rays over that of `wide` alone, and time to build, one line per choice of cells.
#: 1-light-buffer: Throughput of shadow rays over that of wide alone, and seconds to build, by scene, one marker per choice of cells.
#:   Medians with intervals; right of 1 the light buffer is faster. Both axes are logarithmic; what was built once has no
#:   interval. The order in each scene, from top to bottom, is that of the legend.

n_scenes = words(scenes); n_accels = words(accels)
chosen(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
place(s, a) = n_scenes - s + 0.12 * (0.5 * (n_accels + 1) - a)

says(a) = strstrt("0123456789", word(accels, a)[1:1]) ? word(accels, a)." cells" : word(accels, a)

set yrange [-0.6 : n_scenes - 0.4]
set grid xtics ytics
set bars small

columns = across(2, 2); rows = 2 / columns
panel = (columns > 1 ? 62 : 44) * n_scenes
key_rows = rows
height = 60 + 20 * key_rows + (panel + 60) * rows
eval canvas("1-light-buffer", wide, height)
set multiplot layout rows, columns margins screen 130.0 / wide, 0.97, 60.0 / height, 1 - (20.0 + 20 * key_rows) / height \
    spacing screen 0.05, 60.0 / height
set arrow 1 from 1, graph 0 to 1, graph 1 nohead linewidth 1.5 dashtype 2 linecolor rgb soft back
set xlabel "throughput / that of wide" textcolor rgb ink
set ytics ()
do for [s = 1:n_scenes] { set ytics add (word(scenes, s) n_scenes - s) }
set key at screen 0.985, screen 1 - 8.0 / height right top vertical maxrows key_rows samplen 1 textcolor rgb ink
set logscale x 2
eval "set xtics ".ratio_tics(0.2, 2.1)
set xrange [0.2 : 2.1]
plot keyentry with points pointtype marker(1) pointsize 0.65 linecolor rgb color(1) title word(accels, 1), \
     for [a = 2:n_accels] for [s = 1:n_scenes] "times.csv" \
       using (chosen(s, a) ? column("ratio") : NaN):(place(s, a)):(column("ratio_low")):(column("ratio_high")) \
       with xerrorbars linewidth 1.5 pointtype marker(a) pointsize 0.65 linecolor rgb color(a) title (s == 1 ? says(a) : "")
unset key
unset arrow 1
set logscale x 10
set xtics auto; set xrange [*:*]
set format x "10^{%L}"
if (columns > 1) { set ytics (); do for [s = 1:n_scenes] { set ytics add ("" n_scenes - s) } }
set xlabel "time to build, in seconds" textcolor rgb ink
plot for [a = 1:n_accels] for [s = 1:n_scenes] "times.csv" \
       using (chosen(s, a) ? column("build_seconds") : NaN):(place(s, a)):(column("build_low")):(column("build_high")) \
       with xerrorbars linewidth 1.5 pointtype marker(a) pointsize 0.65 linecolor rgb color(a) notitle
unset multiplot
unset output
