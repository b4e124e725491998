# SPDX-License-Identifier: Apache-2.0
# item-buffer: throughput of whole frames over that of wide, by samples along a side, without the buffer's build and with it in one
# frame or ten.
#: 1-frames: Throughput of whole frames over that of wide, over the samples along a side, without the buffer's build and with it
#:   in one frame or ten. Logarithmic axes, one scale. Medians, with intervals without the build; above 1 the item buffer is faster.
#: 2-triangles: The same for a frame of 1024 x 1024 samples over the triangles of the dragon.

names = "bunny dragon871k hall forest tetra"
of(name) = strcol("scene")[1:strlen(name) + 1] eq name."-" && strcol("accel") eq "item"
side(name) = of(name) ? column("width") : NaN

# For `frames` frames including the build: wide's time over the buffer's; wide's build is not counted.
theirs(x) = column("ns") * column("ratio")
with_build(frames) = theirs(0) / (column("ns") + 1e9 * column("build_seconds") / (frames * weight(0)))

set logscale x 2
set xrange [200 : 2600]
set logscale y 2
set yrange [0.4 : 60]
eval "set ytics ".ratio_tics(0.4, 60)
set grid ytics
set xtics (256, 512, 1024, 2048)
set xlabel "samples along a side" textcolor rgb ink

columns = across(3, 3); rows = 3 / columns
height = 72 + 328 * rows
eval canvas("1-frames", wide, height)
set multiplot layout rows, columns margins screen 72.0 / wide, 0.985, 60.0 / height, 1 - 44.0 / height spacing screen 0.04, 108.0 / height
set title "buffer built" font ",14" textcolor rgb ink
set ylabel "throughput / that of wide" textcolor rgb ink
set key top right samplen 2 textcolor rgb ink
plot 1 with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
     for [i = 1:words(names)] "times.csv" using (side(word(names, i))):(column("ratio")):(column("ratio_low")):(column("ratio_high")) \
       with yerrorbars linewidth 1.8 pointtype mark(i) linecolor rgb hue(i) title word(names, i)
unset ylabel; unset key
set title "build counted, one frame" font ",14" textcolor rgb ink
plot 1 with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
     for [i = 1:words(names)] "times.csv" using (side(word(names, i))):(with_build(1)) \
       with points linewidth 1.8 pointtype mark(i) linecolor rgb hue(i) notitle
set title "build counted, ten frames" font ",14" textcolor rgb ink
plot 1 with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
     for [i = 1:words(names)] "times.csv" using (side(word(names, i))):(with_build(10)) \
       with points linewidth 1.8 pointtype mark(i) linecolor rgb hue(i) notitle
unset multiplot
unset output

# The dragon at 11, 48, 202 and 871 thousand triangles.
is_dragon(x) = strcol("scene")[1:6] eq "dragon" && column("width") == 1024 && strcol("accel") eq "item"
set xrange [8000 : 1200000]
set xtics auto
set logscale x 10
set format x "10^{%L}"
set xlabel "triangles of the dragon, 1024 x 1024 samples" textcolor rgb ink
set ylabel "throughput / that of wide" textcolor rgb ink
set key top left samplen 2 textcolor rgb ink
unset title
eval canvas("2-triangles", 480, 400)
plot 1 with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
     "times.csv" using (is_dragon(0) ? column("objects") : NaN):(column("ratio")):(column("ratio_low")):(column("ratio_high")) \
       with yerrorbars linewidth 2 pointtype 7 linecolor rgb hue(2) title "buffer built", \
     "times.csv" using (is_dragon(0) ? column("objects") : NaN):(with_build(1)) \
       with points linewidth 2 pointtype 6 linecolor rgb hue(2) title "build counted, one frame", \
     "times.csv" using (is_dragon(0) ? column("objects") : NaN):(with_build(10)) \
       with points linewidth 2 pointtype 8 linecolor rgb hue(1) title "build counted, ten frames"
unset output
