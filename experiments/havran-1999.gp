# SPDX-License-Identifier: Apache-2.0
# havran-1999: published against measured figures, their deviations row by row, and ours against the best published row.
#: 1-published: Measured over published figures, one panel per column of the published tables, one marker per structure.
#:   Both axes logarithmic; band: the tolerance; large: beyond it.
#: 2-deviations: Deviation of measured figures from published ones in percent, one panel per scene and column, one point per row.
#:   Band: the tolerance; points at the edges lie beyond the panel.
#: 3-best: Tests per ray of ours beside those of the best published row, a pair of bars per scene: left without steps, right with
#:   steps. Blue: what the published rows also count. Orange: extent tests, which they do not count (a grid or an octree makes one
#:   per ray). A hierarchy trades object tests for extent tests: "more" or "fewer" compares the whole bars.
#:   Axes begin at 0.

# Writes published.csv and best.csv.
system("'".shared."/published/havran-1999.sh' .")

n_scenes = words(scenes)
array structure[7] = ["Uniform Grid", "Recursive Grid", "Octree84-C", "Octree84-A", "Octree89-C", "Octree93-C", "Octree93-A"]
array shade[7] = [0x8c8c8c, 0xa6761d, 0x56b4e9, 0xe69f00, 0x0072b2, 0x009e73, 0xd55e00]
array style_of[7] = [7, 5, 9, 11, 13, 6, 4]
array name[6] = ["interior", "leaves", "empty_leaves", "references", "object_tests", "steps"]
array title[6] = ["interior nodes", "leaves", "empty leaves", "references", "object tests", "steps"]
array tolerance[6] = [1, 1, 1, 3, 3, 3]
number = 0
number_of(text) = sum [i = 1:7] (structure[i] eq text ? i : 0)
shade_of(text) = number_of(text) > 0 ? shade[number_of(text)] : 0
mark_of(text) = number_of(text) > 0 ? style_of[number_of(text)] : 1
is(m) = strcol("column") eq name[m] && strcol("measured") ne ""
do for [m = 1:6] {
  stats "published.csv" using (is(m) ? column("tolerance") : NaN) nooutput
  tolerance[m] = STATS_records > 0 ? STATS_max : 0
}

# ---- published against measured ----

eval canvas("1-published", 960, 700)
set multiplot
set logscale xy
set format "10^{%T}"
do for [m = 1:6] {
  col = (m - 1) % 3; row = (m - 1) / 3
  set lmargin at screen 0.068 + col * 0.325
  set rmargin at screen 0.068 + col * 0.325 + 0.253
  set tmargin at screen 0.945 - row * 0.46
  set bmargin at screen 0.945 - row * 0.46 - 0.375
  set autoscale # stats looks at what is in range
  stats "published.csv" using (is(m) && column("published") > 0 && column("measured") > 0 ? column("published") : NaN) nooutput
  low = STATS_min / 2; high = STATS_max * 2
  set xrange [low : high]; set yrange [low : high]
  unset label
  set label 1 title[m] at graph 0, 1.06 left font ",15" textcolor rgb ink
  set label 2 sprintf("band: ± %g %%", tolerance[m]) at graph 1, 1.06 right textcolor rgb soft
  if (m == 1) {
    do for [i = 1:7] {
      set label 10 + i structure[i] at screen 0.015 + (i - 1) * 0.14 + (i > 2 ? 0.02 : 0), screen 0.02 left textcolor rgb ink \
          point pointtype style_of[i] pointsize 0.9 linecolor rgb shade[i] offset character 1, 0
    }
  }
  if (m > 3) { set label 3 "published" at graph 0.5, -0.14 center textcolor rgb soft }
  if (col == 0) { set label 4 "measured" at graph -0.2, 0.5 center rotate by 90 textcolor rgb soft }
  factor = 0.01 * tolerance[m]
  set samples 200
  plot "+" using 1:($1 * (1 - factor)):($1 * (1 + factor)) with filledcurves linecolor rgb faint, \
       x with lines linewidth 0.7 linecolor rgb soft, \
       "published.csv" using (is(m) && strcol("within") ne "no" ? column("published") : NaN):"measured":(mark_of(strcol("structure"))):(shade_of(strcol("structure"))) \
         with points pointtype variable pointsize 0.5 linecolor rgb variable, \
       "" using (is(m) && strcol("within") eq "no" ? column("published") : NaN):"measured":(mark_of(strcol("structure"))):(shade_of(strcol("structure"))) \
         with points pointtype variable pointsize 1.2 linewidth 1.4 linecolor rgb variable
}
unset multiplot
unset output

# ---- deviations, one point per row, one panel per scene and column ----

most = 12.0
clipped(x) = x > most ? most : x < -most ? -most : x
eval canvas("2-deviations", 960, 900)
set multiplot
unset logscale
set format x ""
set format y "%+.0f %%"
set yrange [-1.12 * most : 1.12 * most]
set ytics 4
unset xtics
set grid ytics linecolor rgb faint linetype 1 linewidth 0.5
do for [m = 1:6] {
  do for [s = 1:n_scenes] {
    set lmargin at screen 0.075 + (s - 1) * 0.92 / n_scenes + 0.012
    set rmargin at screen 0.075 + s * 0.92 / n_scenes
    set tmargin at screen 0.93 - (m - 1) * 0.149
    set bmargin at screen 0.93 - (m - 1) * 0.149 - 0.129
    set autoscale x
    stats "published.csv" using (is(m) && strcol("scene") eq word(scenes, s) ? 1 : NaN) nooutput
    rows = STATS_records
    set xrange [0 : rows + 1]
    unset label
    if (m == 1) { set label 1 word(scenes, s) at graph 0.5, 1.12 center font ",15" textcolor rgb ink }
    if (m == 1 && s == 1) {
      set label 20 "Measured against published, in %: a point a row. Bands: tolerance; on the edge: beyond the panel." \
        at screen 0.085, screen 0.985 left textcolor rgb soft
    }
    if (s == 1) {
      set label 2 title[m] at screen 0.012, graph 0.5 center rotate by 90 textcolor rgb ink
    }
    if (m == 6 && s == 1) {
      do for [i = 1:7] {
        set label 10 + i structure[i] at screen 0.015 + (i - 1) * 0.14 + (i > 2 ? 0.02 : 0), screen 0.012 left textcolor rgb ink \
          point pointtype style_of[i] pointsize 0.9 linecolor rgb shade[i] offset character 1, 0
      }
    }
    set format y (s == 1 ? "%+.0f %%" : "")
    set ytics
    number = 0
    chosen(i) = is(m) && strcol("scene") eq word(scenes, s)
    count(i) = (number = number + 1, number)
    plot "+" using 1:(-tolerance[m]):(tolerance[m]) with filledcurves linecolor rgb faint, 0 with lines linewidth 0.7 linecolor rgb soft, \
         "published.csv" using (chosen(0) ? count(0) : NaN):(clipped(column("deviation"))):(mark_of(strcol("structure"))): \
           (shade_of(strcol("structure"))) with points pointtype variable pointsize 0.55 linecolor rgb variable
  }
}
unset multiplot
unset output

# ---- ours against the best published row ----

eval canvas("3-best", 960, 120 + 76 * n_scenes)
set multiplot
unset logscale
set format x "%g"
set format y ""
set xtics nomirror scale 0.5
unset ytics
set grid xtics noytics
set border 2 linecolor rgb soft
theirs = "#b5b5b5"; ours = "#0072b2"; extents = "#e69f00"
do for [m = 1:2] {
  measure = word("object_tests object_tests+steps", m)
  set lmargin at screen 0.075 + (m - 1) * 0.47
  set rmargin at screen 0.075 + (m - 1) * 0.47 + 0.44
  set tmargin at screen 0.88
  set bmargin at screen 0.13
  set autoscale
  stats "best.csv" using (strcol("measure") eq measure ? column("published") : NaN) nooutput
  longest = STATS_max
  stats "best.csv" using (strcol("measure") eq measure ? column("ours") + column("extent_tests") : NaN) nooutput
  if (STATS_max > longest) { longest = STATS_max }
  set xrange [0 : 2.35 * longest]
  set yrange [n_scenes + 0.6 : 0.4]
  unset label
  set label 1 (m == 1 ? "object tests + extent tests" : "object tests and steps + extent tests") at graph 0, 1.05 left \
    font ",15" textcolor rgb ink
  if (m == 1) {
    do for [s = 1:n_scenes] { set label 10 + s word(scenes, s) at graph -0.03, first s right font ",14" textcolor rgb ink }
    set label 2 "■ best published row" at screen 0.075, screen 0.03 left textcolor rgb soft
    set label 3 "■ least of ours" at screen 0.29, screen 0.03 left textcolor rgb ours
    set label 4 "■ its extent tests" at screen 0.435, screen 0.03 left textcolor rgb "#9a6a00"
    set label 5 "Published rows count no extent tests." at screen 0.995, screen 0.03 right \
      textcolor rgb soft
  }
  place(text) = sum [s = 1:n_scenes] (word(scenes, s) eq text ? s : 0)
  at(i) = strcol("measure") eq measure ? place(strcol("scene")) : NaN
  all_tests(i) = column("ours") + column("extent_tests")
  in_all(i) = all_tests(i) < column("published") + 1 ? "fewer" : "{/:Bold more}" # a grid or an octree makes one extent test
  plot "best.csv" using (0):(at(0) - 0.19):(0):(column("published")):(at(0) - 0.36):(at(0) - 0.02) with boxxyerror linecolor rgb theirs, \
       "" using (0):(at(0) + 0.19):(0):(column("ours")):(at(0) + 0.02):(at(0) + 0.36) with boxxyerror linecolor rgb ours, \
       "" using (0):(at(0) + 0.19):(column("ours")):(all_tests(0)):(at(0) + 0.02):(at(0) + 0.36) with boxxyerror linecolor rgb extents, \
       "" using (column("published")):(at(0) - 0.19):(sprintf(" %s  %s", figure(column("published")), strcol("published_row"))) \
         with labels left textcolor rgb soft, \
       "" using (all_tests(0)):(at(0) + 0.19): \
         (sprintf(" %s + %s  %s: %s", figure(column("ours")), figure(column("extent_tests")), strcol("accel"), in_all(0))) \
         with labels left textcolor rgb ink
}
unset multiplot
unset output
