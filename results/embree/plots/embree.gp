# SPDX-License-Identifier: Apache-2.0
# embree: throughput over that of Embree's best, by scene and ray kind; and how Embree's settings compare with the best of
# them. 1 is the best of Embree in both.

n_scenes = words(scenes); n_kinds = words(kinds); n_accels = words(accels)
place(kind) = sum [k = 1:n_kinds] (word(kinds, k) eq kind ? k : 0)
own(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
is_embree(a) = word(accels, a)[1:7] eq "embree-"

# Our own accelerators, and those that are Embree's.
ours = ""; theirs = ""
do for [a = 1:n_accels] { if (is_embree(a)) { theirs = theirs.sprintf("%d ", a) } else { ours = ours.sprintf("%d ", a) } }
n_ours = words(ours)
shift(i) = 0.16 * (i - 0.5 * (n_ours + 1))

set xrange [0.5 : n_kinds + 0.5]
set xtics () rotate by 30 right
do for [k = 1:n_kinds] { set xtics add (word(kinds, k) k) }
set grid ytics

eval svg("1-embree", 120 + 270 * n_scenes, 420)
set multiplot layout 1, n_scenes margins screen 0.06, 0.985, 0.24, 0.80 spacing screen 0.04, 0.1
set yrange [0 : *]
do for [s = 1:n_scenes] {
  set title word(scenes, s) font ",14" textcolor rgb ink
  if (s == 1) {
    set ylabel "throughput / Embree's best" textcolor rgb ink
    set key at screen 0.985, screen 0.98 right top vertical maxrows 1 samplen 2 textcolor rgb ink
  } else { unset key; unset ylabel }
  plot 1 with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
       for [i = 1:n_ours] a = int(word(ours, i)) "times.csv" \
         using (own(s, a) ? place(strcol("kind")) + shift(i) : NaN):(column("ratio")):(column("ratio_low")):(column("ratio_high")) \
         with yerrorbars linewidth 2 pointtype 7 linecolor rgb color(a) title word(accels, a)
}
unset multiplot
unset output

# By the way of asking, from left to right in each kind: one ray, packets of 8 and 16, streams; of each the medium build
# left of the high one.
queries = "1 8 16 stream"
hue(q) = word("#222222 #2f6f9f #c1543c #3a8a4d", q)
named(s, q, quality, isa) = strcol("scene") eq word(scenes, s) && \
                            strcol("accel") eq sprintf("embree-%s-%s-%s", word(queries, q), quality, isa)
at(s, q, isa) = named(s, q, "medium", isa) ? place(strcol("kind")) + 0.2 * (q - 2.5) - 0.03 : \
                named(s, q, "high", isa) ? place(strcol("kind")) + 0.2 * (q - 2.5) + 0.03 : NaN

eval svg("2-settings", 120 + 270 * n_scenes, 420)
set multiplot layout 1, n_scenes margins screen 0.06, 0.985, 0.24, 0.74 spacing screen 0.04, 0.1
set yrange [0 : 1.1]
do for [s = 1:n_scenes] {
  set title word(scenes, s) font ",14" textcolor rgb ink
  if (s == 1) {
    set ylabel "throughput / Embree's best" textcolor rgb ink
    set key at screen 0.985, screen 0.99 right top vertical maxrows 2 samplen 1 textcolor rgb ink
  } else { unset key; unset ylabel }
  plot for [q = 1:4] "times.csv" using (at(s, q, "avx2")):(column("ratio")) \
         with points pointtype 6 pointsize 0.7 linewidth 1.5 linecolor rgb hue(q) title "avx2, query=".word(queries, q), \
       for [q = 1:4] "times.csv" using (at(s, q, "avx512")):(column("ratio")) \
         with points pointtype 7 pointsize 0.7 linecolor rgb hue(q) title "avx512, query=".word(queries, q)
}
unset multiplot
unset output
