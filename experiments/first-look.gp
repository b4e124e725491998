# SPDX-License-Identifier: Apache-2.0
# first-look: the table of frames as bars, one column of panels per scene.
#: frame: Time to trace a whole frame on one thread, and its object and extent tests, with each accelerator, on logarithmic axes.
#:   In brackets: how many times as fast as without a structure. Orange: the fastest of the four structures; blue: the other
#:   classic ones. item and light are buffers over wide. Builds, which use all processors, are in the table. embree counts
#:   no tests; ideal bounds object tests, not time.
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
paint(best) = best ? 0xd55e00 : strcol("group") eq among || strstrt(strcol("accel"), "+") ? 0x56b4e9 : 0x9a9a9a
here(s) = strcol("scene") eq word(scenes, s)
figure_of(s, column_name) = here(s) ? column(column_name) : NaN
at(s) = here(s) ? row_of(strcol("accel")) : NaN
least_of(a, b) = a < b ? a : b
most_of(a, b) = a > b ? a : b

left = 130.0; gap = 14.0; line = 19.0; head = 56.0; foot = 14.0; top = 34.0
panel_height = line * rows
panel_width = (960 - left) / n_scenes

# Puts the names of the rows to the left of a panel at height `bottom` of the canvas.
names = "do for [a = 1:n_accels] { set label 100 + a word(accels, a) at graph -0.02, first row[a] right textcolor rgb ink }; \
do for [i = 1:words(headings) / 2] { set label 200 + i word(groups, int(word(headings, 2 * i - 1))) at screen 6.0 / 960, first int(word(headings, 2 * i)) \
left textcolor rgb soft }"

# Puts the figures of the axis above a panel, below the name of its scene.
figures_above = "set xtics offset 0, screen (panel_height + 17) / height"

# ---- a whole frame: time, and tests ----

# The tests of a whole frame, in millions: per ray of each kind times its rays; NaN if they are not counted.
array tests[2 * n_scenes * n_accels]
at_test(m, s, a) = 1 + m + 2 * (s - 1 + n_scenes * (a - 1))
do for [m = 0:1] {
  counter = word("object_tests extent_tests", m + 1)
  do for [s = 1:n_scenes] {
    do for [a = 1:n_accels] {
      is_row(i) = here(s) && strcol("accel") eq word(accels, a)
      stats "times.csv" using (is_row(0) ? 1e-6 * weight(0) * column(counter) / column("rays") : 0) nooutput
      tests[at_test(m, s, a)] = STATS_sum > 0 ? STATS_sum : NaN
    }
  }
}
tests_of(m, s) = tests[at_test(m, s, number(strcol("accel")))]
is_best(s) = strcol("winner") eq "yes"
speed(s) = figure(column("ms"))." (".figure(column("times_faster")).")"
legend = "set label 11 'the fastest of the four structures' at screen 0.12, screen 1 - 10.0 / height left textcolor rgb '#b34e00'; \
set label 12 'other classic ones' at screen 0.42, screen 1 - 10.0 / height left textcolor rgb '#2f8fc4'; \
set label 13 'the rest' at screen 0.60, screen 1 - 10.0 / height left textcolor rgb soft"
tests_legend = "set label 11 '■ object tests' at screen 0.62, screen 1 - (top + block - 2.0) / height left textcolor rgb '#0072b2'; \
set label 12 '■ extent tests' at screen 0.77, screen 1 - (top + block - 2.0) / height left textcolor rgb '#9a6a00'"
array title[2] = ["Time to trace a frame on one thread, ms, logarithmic (in brackets: times as fast as ".without.")", \
  "Tests of a frame, millions, logarithmic: object + extent tests"]
block = head + panel_height + foot
height = top + 2 * block
eval canvas("frame", 960, height)
set multiplot
set logscale x
set format x "%g"
unset ytics
set grid xtics noytics
set border 1
set xtics scale 0
do for [m = 1:2] {
  set autoscale # stats looks at what is in range
  if (m == 1) {
    stats "frame.csv" using (column("ms")) nooutput
    least = STATS_min; most = STATS_max
  } else {
    least = 1e30; most = 0
    do for [i = 1:|tests|] {
      if (tests[i] > 0) { least = least_of(least, tests[i]); most = most_of(most, tests[i]) }
    }
  }
  least = least / 1.5
  last = least * (most / least) ** (1 / (m == 1 ? 0.66 : 0.60)) # room for figures behind the bars
  set xrange [least : last]
  set yrange [rows + 0.7 : 0.3]
  set xtics 1, 100, 10 ** ceil(log10(most))
  eval figures_above
  do for [s = 1:n_scenes] {
    unset label
    set lmargin at screen (left + (s - 1) * panel_width) / 960
    set rmargin at screen (left + s * panel_width - gap) / 960
    set tmargin at screen 1 - (top + (m - 1) * block + head) / height
    set bmargin at screen 1 - (top + (m - 1) * block + head + panel_height) / height
    if (s == 1) {
      set label 1 title[m] at screen 6.0 / 960, screen 1 - (top + (m - 1) * block - 2.0) / height left font ",15" textcolor rgb ink
      eval names
      eval (m == 1 ? legend : tests_legend)
    }
    set label 2 word(scenes, s) at graph 0, graph 1 left offset 0, 1.6 font ",14" textcolor rgb ink
    if (m == 1) {
      plot "frame.csv" using (least):(at(s)):(least):(column("ms")):(at(s) - 0.36):(at(s) + 0.36):(paint(is_best(s))) \
             with boxxyerror linecolor rgb variable, \
           "" using (column("ms")):(at(s)):(here(s) ? is_best(s) ? "{/:Bold ".speed(s)."}" : speed(s) : "") \
             with labels left offset 0.4, 0 textcolor rgb ink
    } else {
      plot "frame.csv" using (least):(at(s)):(least):(here(s) ? tests_of(0, s) : NaN):(at(s) - 0.38):(at(s)) \
             with boxxyerror linecolor rgb "#0072b2", \
           "" using (least):(at(s)):(least):(here(s) ? tests_of(1, s) : NaN):(at(s)):(at(s) + 0.38) with boxxyerror linecolor rgb "#e69f00", \
           "" using (here(s) ? most_of(tests_of(0, s), tests_of(1, s) > 0 ? tests_of(1, s) : 0) : NaN):(at(s)): \
             (here(s) ? tests_of(1, s) > 0 ? figure(tests_of(0, s))." + ".figure(tests_of(1, s)) : figure(tests_of(0, s)) : "") \
             with labels left offset 0.4, 0 textcolor rgb ink
    }
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
set format x "10^{%T}"
eval figures_above
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
  set label 2 word(scenes, s) at graph 0, graph 1 left offset 0, 1.6 font ",14" textcolor rgb ink
  plot for [p = 1:n_parts] "frame.csv" using (figure_of(s, part[p])):(row_of(strcol("accel"))) with points \
         pointtype mark(p) pointsize 0.9 linecolor rgb hue(p) title part_title[p]
}
unset multiplot
unset output
