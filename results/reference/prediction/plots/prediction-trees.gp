# SPDX-License-Identifier: Apache-2.0
# prediction-trees: for hierarchies over the same triangles, the correlation of time with (1 - alpha) SAH cost + alpha
# end-point overlap + beta leaf-count variability: one panel per family of hierarchies, one curve per ray kind. Means over scenes;
# alpha and beta are the same for all scenes.
#: 4-trees: Correlation of time with a weighted sum of cost and end-point overlap, over the weight of the overlap, one panel per
#:   family of hierarchies, one line per ray kind. Means over scenes; the marker shows the best weight.

scenes = all_scenes; accels = all_accels
tree_scenes = "soup crowd bunny dragon hall forest"
families = "bvh clusters wide"
n_families = words(families); n_scenes = words(tree_scenes); n_kinds = words(kinds)
n_cells = n_families * n_scenes * n_kinds
cell(f, s, k) = ((f - 1) * n_scenes + s - 1) * n_kinds + k
of_family(f) = strstrt(strcol("accel"), word(families, f)) == 1 && strstrt(strcol("accel"), "(again)") == 0
inside(f, s, k) = strcol("scene") eq word(tree_scenes, s) && strcol("kind") eq word(kinds, k) && of_family(f)

# ---- covariances of cost, overlap, variability and time over the hierarchies of a family ----

unset logscale; set xrange [*:*]; set yrange [*:*] # statistics leave out what lies beyond
quality = "predicted_cost end_point_overlap leaf_count_variability"
array known[n_cells]; array var_time[n_cells]
array var_1[n_cells]; array var_2[n_cells]; array var_3[n_cells]         # of cost, overlap, variability
array with_1[n_cells]; array with_2[n_cells]; array with_3[n_cells]      # these with time
array both_12[n_cells]; array both_13[n_cells]; array both_23[n_cells]   # and with one another
covariance = 'STATS_stddev_x > 0 && STATS_stddev_y > 0 ? STATS_correlation * STATS_stddev_x * STATS_stddev_y : 0'
do for [f = 1:n_families] { do for [s = 1:n_scenes] { do for [k = 1:n_kinds] {
  c = cell(f, s, k)
  known[c] = 0
  if (strstrt(" ".scenes." ", " ".word(tree_scenes, s)." ") > 0) {
    known[c] = 1
    do for [q = 1:3] {
      stats "times.csv" using (inside(f, s, k) ? column(word(quality, q)) : NaN):(column("ns")) nooutput
      var_time[c] = STATS_stddev_y ** 2
      eval sprintf("var_%d[c] = STATS_stddev_x ** 2; with_%d[c] = %s", q, q, covariance)
      if (q < 3) {
        do for [p = q + 1:3] {
          stats "times.csv" using (inside(f, s, k) ? column(word(quality, q)) : NaN):(column(word(quality, p))) nooutput
          eval sprintf("both_%d%d[c] = %s", q, p, covariance)
        }
      }
    }
  }
} } }

# ---- correlation of time with a weighted sum of them ----

variance(c, u, v, w) = u * u * var_1[c] + v * v * var_2[c] + w * w * var_3[c] \
                       + 2 * (u * v * both_12[c] + u * w * both_13[c] + v * w * both_23[c])
safe_root(x) = x > 0 ? sqrt(x) : 1
correlation(c, u, v, w) = (u * with_1[c] + v * with_2[c] + w * with_3[c]) / safe_root(variance(c, u, v, w) * var_time[c])
n_known(f, k) = sum [s = 1:n_scenes] known[cell(f, s, k)]
mean(f, k, alpha, beta) = (sum [s = 1:n_scenes] (known[cell(f, s, k)] ? correlation(cell(f, s, k), 1 - alpha, alpha, beta) : 0)) / n_known(f, k)

# ---- the best weights; the same for a single scene ----

array best_alpha[n_families * n_kinds]
set print "plots/4-trees.csv"
print "family,kind,scene,r_cost,r_overlap,alpha,r_both,alpha_3,beta_3,r_all"
do for [f = 1:n_families] { do for [k = 1:n_kinds] { do for [s = 0:n_scenes] {
  shown = s == 0 ? n_known(f, k) : known[cell(f, s, k)]
  if (shown) {
    r_at(alpha, beta) = s == 0 ? mean(f, k, alpha, beta) : correlation(cell(f, s, k), 1 - alpha, alpha, beta)
    a2 = 0; a3 = 0; b3 = 0; r2 = r_at(0, 0); r3 = r2
    do for [i = 0:50] {
      do for [j = 0:25] {
        r = r_at(0.02 * i, 0.2 * j)
        if (j == 0 && r > r2 + 1e-9) { r2 = r; a2 = 0.02 * i }
        if (r > r3 + 1e-9) { r3 = r; a3 = 0.02 * i; b3 = 0.2 * j }
      }
    }
    if (s == 0) { best_alpha[(f - 1) * n_kinds + k] = a2 }
    print sprintf("%s,%s,%s,%.3f,%.3f,%.2f,%.3f,%.2f,%.1f,%.3f", word(families, f), word(kinds, k), \
                  s == 0 ? "mean" : word(tree_scenes, s), r_at(0, 0), r_at(1, 0), a2, r2, a3, b3, r3)
  }
} } }
unset print

# ---- drawing ----

eval canvas("4-trees", 960, 400)
set multiplot layout 1, n_families margins screen 0.08, 0.985, 0.15, 0.9 spacing screen 0.02, 0.1
set grid xtics ytics
set border 3; set xtics nomirror; set ytics nomirror textcolor rgb ink
set xrange [0 : 1]; set yrange [0.5 : 1]
set samples 101
do for [f = 1:n_families] {
  set title word(families, f) textcolor rgb ink font ",14"
  set xlabel "α: weight of overlap; of cost 1 - α" textcolor rgb ink
  set format y (f == 1 ? "%g" : "")
  set ylabel (f == 1 ? "correlation with ns per ray" : "") textcolor rgb ink
  if (f == 1) { set key left bottom textcolor rgb ink samplen 1.5 } else { unset key }
  plot for [k = 1:n_kinds] mean(f, k, x, 0) with lines linewidth 2 dashtype stroke(k) linecolor rgb hue(k) title word(kinds, k), \
       for [k = 1:n_kinds] "+" using (best_alpha[(f - 1) * n_kinds + k]):(mean(f, k, best_alpha[(f - 1) * n_kinds + k], 0)) every ::0::0 \
         with points pointtype mark(k) pointsize 0.9 linecolor rgb hue(k) notitle
}
unset multiplot
unset key
unset output
