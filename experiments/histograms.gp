# SPDX-License-Identifier: Apache-2.0
# Histograms of object tests and steps per ray, one figure per scene, one column of panels per ray kind, and one of the leaves of
# structures. Both axes are logarithmic: heights are fractions per doubling of the value, so areas compare; a point
# is in the middle of its bin, and 0 is drawn at 1/2. raytally runs this if an experiment sets `distributions`.
#: histograms-*: Object tests and steps of each ray, and sizes and depths of leaves, as fractions per doubling of the value.
#:   Both axes are logarithmic; 0 is drawn at 1/2.

reset
load shared."/style.gp"
n_kinds = words(kinds); n_accels = words(accels)
first(low) = low < 1 ? 0.5 : low
middle(low, end) = low < 1 ? 0.5 : sqrt(low * (end - 1))
most_of(a, b) = a > b ? a : b
density(low, end, part) = part * log(2) / log((end < 1 ? 1 : end) / first(low))
is_panel(s, k, q) = strcol("scene") eq s && strcol("kind") eq k && strcol("quantity") eq q
says(q) = q eq "object_tests" ? "object tests of a ray" : q eq "steps" ? "steps of a ray" : \
          q eq "leaf_size" ? "objects of a leaf" : "depth of a leaf"

set logscale xy
set format x "%g"; set format y "%g"
set xrange [0.4:*]; set yrange [*:*]
set grid xtics ytics linecolor rgb faint linetype 1 linewidth 0.5
width = 300 * (n_kinds + 1)
longest = 0
do for [accel in accels] { if (strlen(accel) > longest) { longest = strlen(accel) } }
key_rows = (n_accels - 1) / int(most_of(1, width / (60 + 9 * longest))) + 1
height = 560.0 + 20 * key_rows
set key at screen 0.5, 0.01 center bottom maxrows key_rows samplen 1 textcolor rgb ink

do for [s = 1:words(scenes)] {
  scene = word(scenes, s)
  eval canvas("histograms-".word(files, s), width, height)
  set multiplot layout 2, n_kinds + 1 columnsfirst margins 0.06, 0.975, (60.0 + 20 * key_rows) / height, 1 - 64.0 / height spacing 0.055, 0.14 \
    title scene.": part of all, per doubling of its value" noenhanced
  do for [i = 1:n_kinds + 1] {
    do for [row = 1:2] {
      kind = i > n_kinds ? "" : word(kinds, i)
      quantity = word(i > n_kinds ? "leaf_size leaf_depth" : "object_tests steps", row)
      set title (row > 1 ? "" : kind eq "" ? "leaves" : kind." rays") offset 0, -0.5
      set xlabel says(quantity) offset 0, 0.5
      stats "histograms.csv" using (is_panel(scene, kind, quantity) ? 1 : 0) nooutput
      if (STATS_sum > 0) {
        plot for [a = 1:n_accels] "histograms.csv" \
          using (is_panel(scene, kind, quantity) && strcol("accel") eq word(accels, a) ? \
                 middle(column("low"), column("end")) : NaN):(density(column("low"), column("end"), column("part"))) \
          with linespoints pointtype marker(a) pointsize 0.4 dashtype dash(a) linewidth 1.5 linecolor rgb color(a) title word(accels, a) noenhanced
        unset key
      } else { set multiplot next }
    }
  }
  unset multiplot
  set key
}
