# SPDX-License-Identifier: Apache-2.0
# first-look: costs per ray and of building, a row of panels a scene; and time by ray kind.

n_scenes = words(scenes); n_accels = words(accels); n_kinds = words(kinds)

# ---- from the CSV files: value[metric, scene, accelerator], time a ray by kind with its interval ----

chosen(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
known(s, a, counter) = chosen(s, a) && strcol(counter) ne ""
place(m, s, a) = ((m - 1) * n_scenes + s - 1) * n_accels + a
n_metrics = 6
array value[n_metrics * n_scenes * n_accels]
array title[n_metrics] = ["object tests / ray", "extent tests / ray", "steps / ray", "ns / ray", "build, ms", "memory, MB"]

do for [s = 1:n_scenes] {
  do for [a = 1:n_accels] {
    do for [m = 1:3] {
      counter = word("object_tests extent_tests steps", m)
      stats "times.csv" using (known(s, a, counter) ? column("set_rays") : 0) nooutput
      weight = STATS_sum
      stats "times.csv" using (known(s, a, counter) ? column(counter) / column("rays") * column("set_rays") : 0) nooutput
      value[place(m, s, a)] = weight > 0 ? STATS_sum / weight : NaN
    }
    stats "times.csv" using (chosen(s, a) ? column("set_rays") : 0) nooutput
    timed = STATS_sum
    stats "times.csv" using (chosen(s, a) ? column("ns") * column("set_rays") : 0) nooutput
    value[place(4, s, a)] = timed > 0 ? STATS_sum / timed : NaN
    stats "times.csv" using (chosen(s, a) ? column("build_seconds") * 1e3 : 0) nooutput
    value[place(5, s, a)] = timed > 0 ? STATS_max : NaN
    stats "times.csv" using (chosen(s, a) ? column("bytes") * 1e-6 : 0) nooutput
    value[place(6, s, a)] = timed > 0 ? STATS_max : NaN
  }
}

# ---- the overview: bars to the right, one accelerator a line, the same line in every panel ----

left = 0.105; top = 0.90; bottom = 0.04
panel_width = (0.995 - left) / n_metrics; panel_height = (top - bottom) / n_scenes
array lowest[n_metrics] = [0.1, 0.1, 0.1, 1, 0.01, 0.001]

eval svg("1-overview", 1240, 90 + 195 * n_scenes)
set multiplot
set logscale x
set yrange [n_accels + 0.6 : 0.4]
set xtics format "" scale 0
set border 2 linecolor rgb soft
do for [s = 1:n_scenes] {
  do for [m = 1:n_metrics] {
    highest = lowest[m]
    do for [t = 1:n_scenes] {
      do for [a = 1:n_accels] {
        v = value[place(m, t, a)]
        if (v == v && v > highest) { highest = v }
      }
    }
    # room for the figure behind the longest bar
    set xrange [lowest[m] : lowest[m] * (highest / lowest[m]) ** 1.42]
    set lmargin at screen left + (m - 1) * panel_width + 0.012
    set rmargin at screen left + m * panel_width
    set tmargin at screen top - (s - 1) * panel_height - 0.035
    set bmargin at screen top - s * panel_height + 0.015
    unset label
    unset ytics
    if (m == 1 && s == 1) {
      set label 3 "Means over all kinds of rays. Logarithmic: a grid line is a factor of ten. – not known; ideal is the floor." \
        at screen left, screen 0.018 left font ",12" textcolor rgb soft
    }
    if (m == 1) {
      set label 1 word(scenes, s) at graph 0, 1.07 right font ",16" textcolor rgb ink
      do for [a = 1:n_accels] {
        set label 100 + a word(accels, a) at graph -0.04, first a right textcolor rgb color(a) font ",13"
      }
    }
    if (s == 1) { set label 2 title[m] at graph 0, screen top + 0.055 left font ",14" textcolor rgb ink }
    do for [a = 1:n_accels] {
      v = value[place(m, s, a)]
      set label 200 + a figure(v) at first (v == v && v > lowest[m] ? v : lowest[m]), first a left offset character 0.2, 0 \
          textcolor rgb (v == v ? ink : soft) font ",12"
    }
    plot for [a = 1:n_accels] "+" using (lowest[m]):(a):(lowest[m]): \
           (value[place(m, s, a)] > lowest[m] ? value[place(m, s, a)] : NaN):(a - 0.36):(a + 0.36) every ::0::0 \
           with boxxyerror linecolor rgb color(a)
  }
}
unset multiplot
unset output

# ---- time by ray kind: a group of bars a kind, an accelerator a colour, the interval on top ----

reset session
load "plots/names.gp"
load "plots/style.gp"
n_scenes = words(scenes); n_accels = words(accels); n_kinds = words(kinds)
chosen(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
number(kind) = sum [k = 1:n_kinds] (word(kinds, k) eq kind ? k : 0)
width = 0.86 / n_accels
x_of(a) = number(strcol("kind")) + (a - (n_accels + 1) / 2.0) * width

array cells[n_scenes * n_kinds]
do for [s = 1:n_scenes] {
  do for [k = 1:n_kinds] {
    stats "times.csv" using (strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) ? 1 : 0) nooutput
    cells[(s - 1) * n_kinds + k] = STATS_sum > 0
  }
}

eval svg("2-time-by-kind", 1240, 70 + 260 * n_scenes)
set multiplot
set logscale y
set format y "10^{%T}"
set grid noxtics ytics
set xrange [0.5 : n_kinds + 0.5]
set yrange [10 : *]
set xtics scale 0 ()
do for [k = 1:n_kinds] { set xtics add (word(kinds, k) k) }
do for [s = 1:n_scenes] {
  set lmargin at screen 0.07
  set rmargin at screen 0.99
  set tmargin at screen 1 - (76 + 260.0 * (s - 1)) / (70 + 260 * n_scenes)
  set bmargin at screen 1 - (14 + 260.0 * s) / (70 + 260 * n_scenes)
  set label 1 word(scenes, s).", ns / ray" at graph 0, 1.08 left font ",15" textcolor rgb ink
  do for [k = 1:n_kinds] {
    note = cells[(s - 1) * n_kinds + k] ? "" : "no such rays"
    set label 10 + k note at first k, graph 0.06 center font ",12" textcolor rgb soft
  }
  if (s == 1) {
    set key at screen 0.99, screen 0.985 right top horizontal samplen 1 maxrows 1 textcolor rgb ink width 1
  } else { unset key }
  plot for [a = 1:n_accels] "times.csv" using (chosen(s, a) ? x_of(a) : NaN):"ns":(width * 0.92) with boxes \
         linecolor rgb color(a) title word(accels, a), \
       for [a = 1:n_accels] "times.csv" using (chosen(s, a) ? x_of(a) : NaN):"ns_low":(0):(column("ns_high") - column("ns_low")) \
         with vectors nohead linewidth 1.5 linecolor rgb ink notitle
}
unset multiplot
unset output
