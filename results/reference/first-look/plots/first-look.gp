# SPDX-License-Identifier: Apache-2.0
# first-look: the table of frames as bars, one column of panels per scene.
#: frame: Speedup and reduction in object tests of each accelerator for a whole frame over no structure, on logarithmic axes.
#:   The columns at the right are milliseconds to trace a frame and to build, and millions of object tests. Blue: the classic ones;
#:   orange: the best of the four structures. item and light are buffers over wide: the pale part of a bar is what wide alone
#:   reaches, the figure in brackets the gain over it. ideal bounds object tests, not time.
#: by-kind: Speedup over no structure, for each ray kind.
#:   Logarithmic axes; secondary rays are reflected and transmitted ones. The item buffer answers only primary rays, the light
#:   buffer only shadow rays.

n_scenes = words(scenes); n_accels = words(accels)


# ---- rows: a heading and the accelerators of each group ----

array row[n_accels]
rows = 0; headings = ""
do for [a = 1:n_accels] {
  if (a == 1 || word(groups, a) ne word(groups, a > 1 ? a - 1 : 1)) { rows = rows + 1; headings = headings.sprintf("%d %d ", a, rows) }
  rows = rows + 1; row[a] = rows
}
number(name) = sum [a = 1:n_accels] (word(accels, a) eq name ? a : 0)
row_of(name) = number(name) ? row[number(name)] : NaN
paint(best) = best ? 0xd55e00 : strcol("group") eq among || strcol("below") ne "" ? 0x56b4e9 : 0x9a9a9a
here(s) = strcol("scene") eq word(scenes, s)
figure_of(s, column_name) = here(s) ? column(column_name) : NaN
at(s) = here(s) ? row_of(strcol("accel")) : NaN
least_of(a, b) = a < b ? a : b
most_of(a, b) = a > b ? a : b

left = 130.0; gap = 14.0; line = 19.0; head = 44.0; foot = 30.0; top = 34.0
panel_height = line * rows
panel_width = (960 - left) / n_scenes

# Puts the names of the rows to the left of a panel at height `bottom` of the canvas.
names = "do for [a = 1:n_accels] { set label 100 + a word(accels, a) at graph -0.02, first row[a] right textcolor rgb ink }; \
do for [i = 1:words(headings) / 2] { set label 200 + i word(groups, int(word(headings, 2 * i - 1))) at screen 6.0 / 960, first int(word(headings, 2 * i)) \
left textcolor rgb soft }"

legend = "set label 11 'the six classic accelerators' at screen 6.0 / 960, screen 1 - 12.0 / height left textcolor rgb '#3a9fd8'; \
set label 12 '{/:Bold the best of the four structures}' at screen 0.25, screen 1 - 12.0 / height left textcolor rgb '#d55e00'; \
set label 13 'pale: wide alone; in brackets: gain over wide' at screen 0.995, screen 1 - 12.0 / height right textcolor rgb soft"

# ---- a whole frame: speedup, and reduction in object tests ----

n_metrics = 2
array metric[2] = ["times_faster", "times_fewer"]
array gain[2] = ["gain", "tests_gain"]
# Pixels of the columns at the right, and of a figure behind a bar.
array columns[2] = [112, 52]; figure_width = 92
whole(s, m) = figure_of(s, metric[m])
below(s, m) = figure_of(s, metric[m]) / column(gain[m])
array title[2] = ["A whole frame: how many times faster than ".without.", log scale", "How many times fewer object tests than ".without.", log scale"]
array least[2]; array most[2]; array best[2 * n_scenes]
do for [m = 1:n_metrics] {
  stats "frame.csv" using (column(metric[m])) nooutput
  least[m] = least_of(1, STATS_min); most[m] = STATS_max
  do for [s = 1:n_scenes] {
    stats "frame.csv" using (here(s) && strcol("group") eq among ? column(metric[m]) : NaN) nooutput
    best[2 * s - 2 + m] = STATS_max
  }
}
is_best(s, m) = strcol("group") eq among && column(metric[m]) == best[2 * s - 2 + m]
label(s, m) = figure(whole(s, m)).(strcol("below") ne "" ? " (".figure(column(gain[m])).")" : "")
block = head + panel_height + foot
height = top + n_metrics * block
eval canvas("frame", 960, height)
set multiplot
set logscale x
set format x "10^{%T}"
set yrange [rows + 0.7 : 0.3]
unset ytics
set grid xtics noytics
set border 1
set xtics scale 0.4 offset 0, 0.4
do for [m = 1:n_metrics] {
  lowest = least[m]
  last = lowest * (most[m] / lowest) ** ((panel_width - gap) / (panel_width - gap - columns[m] - figure_width))
  set xrange [lowest : last]
  set xtics 1, (m == 1 ? 1000 : 100), 10 ** ceil(log10(most[m]))
  do for [s = 1:n_scenes] {
    unset label
    set lmargin at screen (left + (s - 1) * panel_width) / 960
    set rmargin at screen (left + s * panel_width - gap) / 960
    set tmargin at screen 1 - (top + (m - 1) * block + head) / height
    set bmargin at screen 1 - (top + (m - 1) * block + head + panel_height) / height
    if (s == 1) {
      set label 1 title[m] at screen 6.0 / 960, screen 1 - (top + (m - 1) * block + 2.0) / height left font ",15" textcolor rgb ink
      eval names
      if (m == 1) { eval legend }
    }
    set label 2 word(scenes, s) at graph 0, graph 1 left offset 0, 0.7 font ",14" textcolor rgb ink
    set label 3 (m == 1 ? "ms" : "") at graph 0.80, graph 1 right offset 0, 0.7 textcolor rgb soft
    set label 4 (m == 1 ? "build" : "million tests") at graph 1, graph 1 right offset 0, 0.7 textcolor rgb soft
    # The gain of the accelerator below an overlay, then that of the overlay: logarithms add.
    plot "frame.csv" using (least_of(1, below(s, m))):(at(s)):(least_of(1, below(s, m))):(most_of(1, below(s, m))):(at(s) - 0.36):(at(s) + 0.36) \
           with boxxyerror linecolor rgb faint, \
         "" using (least_of(whole(s, m), below(s, m))):(at(s)):(least_of(whole(s, m), below(s, m))):(most_of(whole(s, m), below(s, m))): \
           (at(s) - 0.36):(at(s) + 0.36):(paint(is_best(s, m))) with boxxyerror linecolor rgb variable, \
         "" using (most_of(1, most_of(whole(s, m), below(s, m)))):(at(s)):(here(s) ? is_best(s, m) ? "{/:Bold ".label(s, m)."}" : label(s, m) : "") \
           with labels left offset 0.4, 0 textcolor rgb ink, \
         "" using (here(s) ? last : NaN):(at(s)):(here(s) ? figure(m == 1 ? column("build_ms") : 1e-6 * column("object_tests")) : "") \
           with labels right textcolor rgb soft, \
         "" using (here(s) && m == 1 ? lowest * (last / lowest) ** 0.79 : NaN):(at(s)):(here(s) ? figure(column("ms")) : "") \
           with labels right textcolor rgb soft
  }
}
unset multiplot
unset output

# ---- by ray kind ----

n_parts = 3
array part[3] = ["primary_faster", "shadow_faster", "secondary_faster"]
array part_title[3] = ["primary", "shadow", "secondary"]
height = top + head + panel_height + foot
eval canvas("by-kind", 960, height)
set multiplot
set xtics 1, 10, 1e9
do for [s = 1:n_scenes] {
  unset label
  set lmargin at screen (left + (s - 1) * panel_width) / 960
  set rmargin at screen (left + s * panel_width - gap) / 960
  set tmargin at screen 1 - (top + head) / height
  set bmargin at screen 1 - (top + head + panel_height) / height
  set xrange [0.5 : *]
  if (s == 1) {
    eval names
    set label 1 "times as fast as ".without.", by kind of rays" at screen 6.0 / 960, screen 1 - 24.0 / height left font ",15" textcolor rgb ink
    set key at screen 0.995, screen 1 - 6.0 / height right top horizontal maxrows 1 samplen 0.5 width 0 textcolor rgb ink
  } else { unset key }
  set label 2 word(scenes, s) at graph 0, graph 1 left offset 0, 0.7 font ",14" textcolor rgb ink
  plot for [p = 1:n_parts] "frame.csv" using (figure_of(s, part[p])):(row_of(strcol("accel"))) with points \
         pointtype mark(p) pointsize 0.9 linecolor rgb hue(p) title part_title[p]
}
unset multiplot
unset output
