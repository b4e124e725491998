# SPDX-License-Identifier: Apache-2.0
# csg: the savings of extents on the inner nodes of CSG trees, one row of panels for the small trees and one for the large.
#: 1-csg: Solids tested, extents tested and time per ray with and without extents on the inner nodes of CSG trees, one line per
#:   accelerator. Means over all ray kinds, times with intervals; axes begin at 0. Above: trees of 8 to 64 solids; below: of 512.

n_accels = words(accels)
sizes = "small large"
caption = "'8 to 64 solids' '512 solids'"
array title[3] = ["solids tested / ray", "extents tested / ray", "ns / ray"]

# Means over all ray kinds, weighted by the size of the whole set; unknown if a kind was left out.
chosen(size, inner, a) = strcol("scene") eq size."-".inner && strcol("accel") eq word(accels, a)
per_ray(m) = m == 1 ? column("csg_tests") / column("rays") : m == 2 ? column("extent_tests") / column("rays") : column("ns")
array value[12 * n_accels]
array low[12 * n_accels]; array high[12 * n_accels] # of times
place(size, m, inner, a) = (((size - 1) * 3 + m - 1) * 2 + inner - 1) * n_accels + a
do for [s = 1:2] {
  do for [m = 1:3] {
    file = m == 1 ? "counts.csv" : "times.csv" # which has no csg_tests, but Embree
    do for [i = 1:2] {
      inner = word("on off", i)
      whole = 0
      do for [kind in kinds] {
        stats file using (strcol("scene") eq word(sizes, s)."-".inner && strcol("kind") eq kind ? weight(0) : 0) nooutput
        whole = whole + STATS_max
      }
      do for [a = 1:n_accels] {
        stats file using (chosen(word(sizes, s), inner, a) ? weight(0) : 0) nooutput
        measured = STATS_sum
        stats file using (chosen(word(sizes, s), inner, a) ? per_ray(m) * weight(0) : 0) nooutput
        known = measured > 0 && measured == whole
        value[place(s, m, i, a)] = known ? STATS_sum / measured : NaN
        if (m == 3) {
          stats file using (chosen(word(sizes, s), inner, a) ? column("ns_low") * weight(0) : 0) nooutput
          low[place(s, m, i, a)] = known ? STATS_sum / measured : NaN
          stats file using (chosen(word(sizes, s), inner, a) ? column("ns_high") * weight(0) : 0) nooutput
          high[place(s, m, i, a)] = known ? STATS_sum / measured : NaN
        }
      }
    }
  }
}

eval canvas("1-csg", 960, 1000)
set multiplot
set yrange [n_accels + 0.6 : 0.4]
set border 2 linecolor rgb soft
set xtics scale 0.4 offset 0, 0.3
left = 0.125; width = 0.87 / 3
on_color = "#0072b2"; off_color = "#e9a27a"
do for [s = 1:2] {
  do for [m = 1:3] {
    highest = 0
    do for [i = 1:2] { do for [a = 1:n_accels] {
      v = value[place(s, m, i, a)]
      if (v == v && v > highest) { highest = v }
    } }
    set xrange [0 : highest * (m == 3 ? 1.4 : 1.25)]
    power = highest > 0 ? 10 ** floor(log10(highest)) : 1
    set xtics auto; set xtics power * (highest > 5.5 * power ? 5 : highest > 3 * power ? 2 : highest > 1.5 * power ? 1 : 0.5)
    set lmargin at screen left + (m - 1) * width + 0.012
    set rmargin at screen left + m * width
    set tmargin at screen 0.905 - (s - 1) * 0.455
    set bmargin at screen 0.535 - (s - 1) * 0.455
    unset label
    unset ytics
    if (s == 1 && m == 1) {
      set label 3 "■ with inner extents" at screen left + 0.012, screen 0.975 left font ",14" textcolor rgb on_color
      set label 4 "■ without" at screen left + 0.25, screen 0.975 left font ",14" textcolor rgb "#b4521f"
      set label 5 "Means over all kinds of rays." at screen 0.985, screen 0.975 right textcolor rgb soft
    }
    set label 1 title[m] at graph 0, 1.035 left textcolor rgb ink
    if (m == 1) {
      set label 2 word(caption, s) at screen 0.01, graph 1.035 left textcolor rgb ink
      do for [a = 1:n_accels] {
        set label 100 + a word(accels, a) at graph -0.03, first a right textcolor rgb ink
      }
    }
    do for [i = 1:2] { do for [a = 1:n_accels] {
      v = value[place(s, m, i, a)]
      end = v != v ? 0 : m == 3 ? high[place(s, m, i, a)] : v
      set label 200 + 50 * i + a figure(v) at first end, first a + 0.4 * i - 0.6 left \
          offset character 0.3, 0 textcolor rgb ink
    } }
    plot for [i = 1:2] for [a = 1:n_accels] "+" using (0):(a):(0):(value[place(s, m, i, a)]): \
           (a + 0.4 * i - 0.78):(a + 0.4 * i - 0.42) every ::0::0 \
         with boxxyerror linewidth 0.5 linecolor rgb (i == 1 ? on_color : off_color), \
         for [i = 1:2] for [a = 1:n_accels * (m == 3)] "+" using (value[place(s, m, i, a)]):(a + 0.4 * i - 0.6): \
           (low[place(s, m, i, a)]):(high[place(s, m, i, a)]) every ::0::0 with xerrorbars pointtype -1 linewidth 1.5 linecolor rgb ink
  }
}
unset multiplot
unset output
