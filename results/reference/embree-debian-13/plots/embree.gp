# SPDX-License-Identifier: Apache-2.0
# embree: throughput over that of Embree's best, by scene and ray kind; and each of Embree's settings compared with the best of
# them. 1 is the best of Embree in both.
#: 1-embree: Throughput of our hierarchies over that of Embree's best, by ray kind, one panel per scene.
#:   Medians with intervals; above 1 ours is faster.
#: 2-settings: Throughput of each of Embree's settings over that of its best, by ray kind, one panel per scene.
#:   Filled: AVX-512, open: AVX2; markers show the query mode: one ray, packets of 8 and 16, streams. The medium
#:   build is left of the high one.

n_scenes = words(scenes); n_kinds = words(kinds); n_accels = words(accels)
place(kind) = sum [k = 1:n_kinds] (word(kinds, k) eq kind ? k : 0)
own(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
is_embree(a) = word(accels, a)[1:7] eq "embree-"

# Our own accelerators, and Embree's.
ours = ""; theirs = ""
do for [a = 1:n_accels] { if (is_embree(a)) { theirs = theirs.sprintf("%d ", a) } else { ours = ours.sprintf("%d ", a) } }
n_ours = words(ours)
shift(i) = 0.16 * (i - 0.5 * (n_ours + 1))

set xrange [0.5 : n_kinds + 0.5]
set xtics () rotate by 30 right font ",12"
do for [k = 1:n_kinds] { set xtics add (word(kinds, k) k) }
set grid ytics

columns = 3; rows = (n_scenes + columns - 1) / columns
height = 70 + 290 * rows

eval canvas("1-embree", 960, height)
set multiplot layout rows, columns margins screen 0.08, 0.985, 70.0 / height, 1 - 72.0 / height spacing screen 0.045, 105.0 / height
set yrange [0 : *]
do for [s = 1:n_scenes] {
  set title word(scenes, s) font ",14" textcolor rgb ink
  set ylabel (s % columns == 1 ? "throughput / Embree's best" : "") textcolor rgb ink
  if (s == 1) {
    set key at screen 0.985, screen 1 - 8.0 / height right top vertical maxrows 1 samplen 1 textcolor rgb ink
  } else { unset key }
  plot 1 with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
       for [i = 1:n_ours] a = int(word(ours, i)) "times.csv" \
         using (own(s, a) ? place(strcol("kind")) + shift(i) : NaN):(column("ratio")):(column("ratio_low")):(column("ratio_high")) \
         with yerrorbars linewidth 1.6 pointtype marker(a) pointsize 0.8 linecolor rgb color(a) title word(accels, a)
}
unset multiplot
unset output

# By query mode, from left to right in each kind: one ray, packets of 8 and 16, streams; the medium build
# left of the high one.
queries = "1 8 16 stream"
open_mark(q) = int(word("6 4 8 12", q)) # the filled one is the next
named(s, q, quality, isa) = strcol("scene") eq word(scenes, s) && \
                            strcol("accel") eq sprintf("embree-%s-%s-%s", word(queries, q), quality, isa)
at(s, q, isa) = named(s, q, "medium", isa) ? place(strcol("kind")) + 0.2 * (q - 2.5) - 0.03 : \
                named(s, q, "high", isa) ? place(strcol("kind")) + 0.2 * (q - 2.5) + 0.03 : NaN

eval canvas("2-settings", 960, height)
set multiplot layout rows, columns margins screen 0.08, 0.985, 70.0 / height, 1 - 88.0 / height spacing screen 0.045, 105.0 / height
set yrange [0 : 1.1]
do for [s = 1:n_scenes] {
  set title word(scenes, s) font ",14" textcolor rgb ink
  set ylabel (s % columns == 1 ? "throughput / Embree's best" : "") textcolor rgb ink
  if (s == 1) {
    set key at screen 0.985, screen 1 - 8.0 / height right top vertical maxrows 2 samplen 0.5 textcolor rgb ink
  } else { unset key }
  plot for [q = 1:4] "times.csv" using (at(s, q, "avx2")):(column("ratio")) \
         with points pointtype open_mark(q) pointsize 0.8 linewidth 1.5 linecolor rgb hue(q) title "avx2, query=".word(queries, q), \
       for [q = 1:4] "times.csv" using (at(s, q, "avx512")):(column("ratio")) \
         with points pointtype open_mark(q) + 1 pointsize 0.8 linecolor rgb hue(q) title "avx512, query=".word(queries, q)
}
unset multiplot
unset output
