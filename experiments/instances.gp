# SPDX-License-Identifier: Apache-2.0
# instances: a forest of instances and of copies over its trees, and structures above and within instances.
#: 1-growth: Memory, time to build, steps and time of a primary ray in bvh and wide over the number of trees, as instances and as
#:   copies. Logarithmic axes, with intervals.
#: 2-nesting: Time per ray for each structure above instances and within them, one panel per scene and kind of rays. Logarithmic axes,
#:   medians with intervals; bvh-over-grid has bvh above and a grid within.

forests = "instances copies"
trees(f, a, k) = strcol("scene")[1:strlen(word(forests, f)) + 1] eq word(forests, f).":" && strcol("accel") eq word("bvh wide", a) && \
                 strcol("kind") eq k ? column("scene.n") : NaN
amount(m) = m == 1 ? column("bytes") * 1e-6 : m == 2 ? column("build_seconds") * 1e3 : m == 3 ? column("steps") / column("rays") : column("ns")
low(m) = m == 2 ? column("build_low") * 1e3 : m == 4 ? column("ns_low") : amount(m)
high(m) = m == 2 ? column("build_high") * 1e3 : m == 4 ? column("ns_high") : amount(m)
array heading[4] = ["structure, MB", "build, ms", "steps a ray", "ns a ray"]

set logscale xy
set format x "10^{%T}"
set grid xtics ytics
set xrange [0.7 : 1.5e4]
set xlabel "trees" textcolor rgb ink
eval canvas("1-growth", 960, 330)
set multiplot layout 1, 4 margins screen 0.05, 0.985, 0.19, 0.77 spacing screen 0.06, 0.1
do for [m = 1:4] {
  set title heading[m] font ",13" textcolor rgb ink
  if (m == 4) { set key at screen 0.985, screen 0.98 right top vertical maxrows 1 samplen 2 textcolor rgb ink } else { unset key }
  plot for [a = 1:2] for [f = 1:2] "times.csv" using (trees(f, a, "primary")):(amount(m)):(low(m)):(high(m)) with yerrorlines \
    linewidth 1.5 dashtype f pointtype mark(f) pointsize 0.7 linecolor rgb hue(a) title word("bvh wide", a).", ".word(forests, f)
}
unset multiplot
unset output

structures = "bvh wide grid octree"; nested = "forest city flake"; n_kinds = words(kinds)
row(a, w) = a == w && a < 3 ? word(structures, a) : word(structures, a)."-over-".word(structures, w)
cell(s, k, a, w) = strcol("scene") eq word(nested, s) && strcol("kind") eq word(kinds, k) && strcol("accel") eq row(a, w) ? column("ns") : NaN
stats "times.csv" using (strstrt(" ".nested." ", " ".strcol("scene")." ") > 0 ? column("ns") : NaN) nooutput
unset logscale x
set xrange [0.5 : 4.5]
set yrange [STATS_min / 1.3 : STATS_max * 1.3]
set xlabel ""
set format y "%g"
set grid noxtics ytics
height = 100.0 + 180 * n_kinds
eval canvas("2-nesting", 960, height)
set multiplot layout n_kinds, 3 margins screen 0.075, 0.985, 35 / height, 1 - 65 / height spacing screen 0.02, screen 16 / height
do for [k = 1:n_kinds] { do for [s = 1:3] {
  if (k == 1) { set title word(nested, s) font ",13" textcolor rgb ink } else { unset title }
  if (k == n_kinds) { set xtics ("bvh within" 1, "wide" 2, "grid" 3, "octree" 4) } else { set xtics ("" 1, "" 2, "" 3, "" 4) }
  if (s == 1) { set ylabel word(kinds, k)." rays, ns" textcolor rgb ink; set format y "%g" } else { unset ylabel; set format y "" }
  if (k + s == 2) { set key at screen 0.985, screen 0.995 right top vertical maxrows 1 samplen 1 textcolor rgb ink } else { unset key }
  plot for [a = 1:4] for [w = 1:4] "times.csv" using (w + 0.12 * (a - 2.5)):(cell(s, k, a, w)):(column("ns_low")):(column("ns_high")) \
    with yerrorbars linewidth 1.3 pointtype mark(a) pointsize 0.8 linecolor rgb hue(a) title (w == 1 ? word(structures, a)." above" : "")
} }
unset multiplot
unset output
