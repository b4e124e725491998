# SPDX-License-Identifier: Apache-2.0
# prediction: tests and steps of random lines against their prediction from areas; the ratio for all ray kinds; and time from a
# time per ray, test and step fitted to each accelerator. On the eight scenes of all object kinds; prediction-trees.gp draws the
# scenes of triangles.
#: 1-random-lines: Measured object tests and steps of random lines over their prediction from areas, one marker per scene.
#:   One point per accelerator; on the line they agree. Both axes logarithmic.
#: 2-by-kind: Measured over predicted tests and steps, by ray kind, one line per scene, one point per accelerator.
#:   Logarithmic; at 1 they agree. Points are spread within a line to be visible.
#: 3-time: Measured nanoseconds per ray, over those from fitted times of a ray, a test and a step, one marker per scene.
#:   Left with measured tests and steps, right with predicted ones. Both axes logarithmic.

all_scenes = scenes; all_accels = accels
scenes = "points spheres balls tetra mount lattice tree stadium"
accels = "box grid-0.25 grid-1 grid-4 grid-16 grid-64 grid-nested octree-4 octree-6 octree-8 kd bvh bvh-sweep bvh-lbvh \
agglomerative rubin-whitted"
here(s) = strstrt(" ".scenes." ", " ".s." ") > 0
n_scenes = words(scenes); n_accels = words(accels); n_kinds = words(kinds)

# ---- the fraction of random lines that hit the box of the scene: the steps of a grid of one voxel ----

array meets[n_scenes]
do for [s = 1:n_scenes] {
  stats "counts.csv" using (strcol("scene") eq word(scenes, s) && strcol("accel") eq "box" && strcol("kind") eq "random" ? \
                            column("steps") / column("rays") : 0) nooutput
  meets[s] = STATS_max
}
is(s, kind) = strcol("scene") eq word(scenes, s) && strcol("kind") eq kind && strcol("accel") ne "box"
predicted(what) = column("predicted_".what)
measured(what, s) = column(what eq "tests" ? "object_tests" : "steps") / column("rays") / meets[s]

# ---- random lines ----

eval canvas("1-random-lines", 960, 500)
set multiplot
set logscale xy
set grid ytics
set key left top textcolor rgb ink samplen 0.5 spacing 1.05
do for [m = 1:2] {
  what = word("tests steps", m)
  set lmargin at screen 0.085 + (m - 1) * 0.475
  set rmargin at screen 0.505 + (m - 1) * 0.475
  set tmargin at screen 0.91; set bmargin at screen 0.12
  set title (m == 1 ? "object tests" : "steps")." of a random line through the box" textcolor rgb ink font ",14"
  set xlabel "predicted from areas" textcolor rgb ink
  set ylabel (m == 1 ? "measured" : "") textcolor rgb ink
  if (m == 2) { unset key }
  set xrange [(m == 1 ? 0.003 : 3) : (m == 1 ? 3000 : 1000)]
  set yrange [(m == 1 ? 0.003 : 3) : (m == 1 ? 3000 : 1000)]
  plot x with lines linecolor rgb soft linewidth 1 notitle, \
       for [s = 1:n_scenes] "counts.csv" using (is(s, "random") ? predicted(what) : NaN):(measured(what, s)) \
         with points pointtype mark(s) pointsize 0.7 linecolor rgb hue(s) title word(scenes, s)
}
unset multiplot
unset key

# ---- measured over predicted, for each ray kind; the fraction that misses the box counts unchanged ----

eval canvas("2-by-kind", 960, 680)
set multiplot
unset logscale y
set grid xtics noytics
set yrange [n_scenes + 0.6 : 0.4]
set xrange [0.008 : 600]
set xtics ("1/100" 0.01, "" 0.1, "1" 1, "" 10, "100" 100)
unset ylabel
do for [m = 1:2] {
  what = word("tests steps", m)
  do for [k = 1:n_kinds] {
    kind = word(kinds, k)
    set lmargin at screen 0.08 + (k - 1) * 0.23
    set rmargin at screen 0.08 + k * 0.23 - 0.02
    set tmargin at screen 0.94 - (m - 1) * 0.46
    set bmargin at screen 0.585 - (m - 1) * 0.46
    set title (m == 1 ? "tests" : "steps").", ".kind." rays" textcolor rgb ink
    set xlabel (m == 2 ? "measured / predicted" : "") textcolor rgb ink
    unset ytics; unset label
    if (k == 1) {
      do for [s = 1:n_scenes] {
        set label s word(scenes, s) at graph -0.04, first s right textcolor rgb ink
      }
    }
    set arrow 1 from 1, graph 0 to 1, graph 1 nohead linecolor rgb soft
    plot for [s = 1:n_scenes] "counts.csv" using (is(s, kind) ? measured(what, s) * (kind eq "random" ? 1 : meets[s]) / predicted(what) : NaN): \
           (s + 0.5 * rand(0) - 0.25) with points pointtype mark(s) pointsize 0.55 linecolor rgb hue(s)
    unset arrow 1
  }
}
unset multiplot
unset label

# ---- time: ns = a + b tests + c steps for each accelerator, least relative squares over scenes and kinds ----

set xrange [*:*]; set yrange [*:*] # a fit leaves out what lies beyond
set fit quiet nolog errorvariables
array base_ns[n_accels]; array test_ns[n_accels]; array step_ns[n_accels]; array off[n_accels]
own(a) = strcol("accel") eq word(accels, a) && here(strcol("scene")) && column("object_tests") == column("object_tests")
tests_of(a) = own(a) ? column("object_tests") / column("rays") : NaN
set print "plots/3-constants.csv"
print "accel,ns_per_ray,ns_per_test,ns_per_step,typical_error,explained" # the part of the variance of log time
do for [a = 1:n_accels] {
  if (word(accels, a) ne "box") {
    f(x, y) = p * p + q * q * x + r * r * y # none is less than nothing
    p = 5; q = 3; r = 2
    fit f(x, y) "times.csv" using (tests_of(a)):(column("steps") / column("rays")):(column("ns")):(column("ns")) zerror via p, q, r
    base_ns[a] = p * p; test_ns[a] = q * q; step_ns[a] = r * r; off[a] = FIT_STDFIT
    stats "times.csv" using (log(column("ns") / f(tests_of(a), column("steps") / column("rays")))):(own(a) ? log(column("ns")) : NaN) nooutput
    explained = 1 - (STATS_mean_x ** 2 + STATS_stddev_x ** 2) / STATS_stddev_y ** 2
    print sprintf("%s,%.3g,%.3g,%.3g,%.2g,%.2f", word(accels, a), base_ns[a], test_ns[a], step_ns[a], off[a], explained)
  }
}
unset print

# ---- pairs of structures of a family on a scene whose order by time follows from predicted tests and steps ----

set print "plots/3-order.csv"
print "family,kind,pairs,right"
do for [family in "grid octree hierarchy"] {
  members = family eq "grid" ? "grid-0.25 grid-1 grid-4 grid-16 grid-64" : family eq "octree" ? "octree-4 octree-6 octree-8" : \
            "bvh bvh-sweep bvh-lbvh agglomerative rubin-whitted"
  array told[words(members)]; array took[words(members)]
  do for [kind in kinds] {
    pairs = 0; right = 0
    do for [s = 1:n_scenes] {
      do for [i = 1:words(members)] {
        do for [a = 1:n_accels] { if (word(accels, a) eq word(members, i)) { number = a } }
        chosen(column_name) = strcol("scene") eq word(scenes, s) && strcol("kind") eq kind && strcol("accel") eq word(members, i) ? \
                              column(column_name) : NaN
        stats "times.csv" using (chosen("predicted_tests")):(chosen("predicted_steps")) nooutput
        told[i] = base_ns[number] + test_ns[number] * STATS_max_x + step_ns[number] * STATS_max_y
        stats "times.csv" using (chosen("ns")) nooutput
        took[i] = STATS_max
      }
      do for [i = 2:words(members)] {
        do for [j = 1:i - 1] { pairs = pairs + 1; right = right + ((told[i] < told[j]) == (took[i] < took[j])) }
      }
    }
    print sprintf("%s,%s,%d,%d", family, kind, pairs, right)
  }
}
unset print

eval canvas("3-time", 960, 500)
set multiplot
set logscale xy
set grid xtics ytics
set xtics autofreq nomirror; set ytics autofreq nomirror
set format "10^{%T}" # until the end of this plot
set xrange [20 : 200000]; set yrange [20 : 200000]
set key left top textcolor rgb ink samplen 0.5 spacing 1.05
do for [m = 1:2] {
  set lmargin at screen 0.085 + (m - 1) * 0.475
  set rmargin at screen 0.505 + (m - 1) * 0.475
  set tmargin at screen 0.91; set bmargin at screen 0.12
  set title (m == 1 ? "from tests and steps as measured" : "from tests and steps as predicted") textcolor rgb ink font ",14"
  set xlabel "ns per ray by fitted times of a ray, a test and a step" textcolor rgb ink
  set ylabel (m == 1 ? "ns per ray, measured" : "") textcolor rgb ink
  if (m == 2) { unset key }
  per_ray(what) = m == 1 ? column(what eq "tests" ? "object_tests" : "steps") / column("rays") : column("predicted_".what)
  model(a, s) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a) ? \
                base_ns[a] + test_ns[a] * per_ray("tests") + step_ns[a] * per_ray("steps") : NaN
  plot x with lines linecolor rgb soft notitle, \
       for [s = 1:n_scenes] NaN with points pointtype mark(s) pointsize 0.7 linecolor rgb hue(s) title word(scenes, s), \
       for [s = 1:n_scenes] for [a = 1:n_accels] "times.csv" using (word(accels, a) eq "box" ? NaN : model(a, s)):(column("ns")) \
         with points pointtype mark(s) pointsize 0.55 linecolor rgb hue(s) notitle
}
unset multiplot
set format "%g"
unset key
unset output
