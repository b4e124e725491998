# SPDX-License-Identifier: Apache-2.0
# first-look: costs per ray and of building, a row of panels a scene; and time by ray kind.
#: 1-overview: Tests, steps and time per ray, time to build and memory of each accelerator, a row of panels a scene.
#:   Means over all kinds of rays, on logarithmic axes; times with intervals. ideal is the floor; – is not known, or not for
#:   all kinds of rays.
#: 2-time-by-kind: Nanoseconds per ray of each accelerator, by kind of ray, a panel a scene.
#:   Medians with their intervals, on logarithmic axes; from left to right in the order of the legend.

n_scenes = words(scenes); n_accels = words(accels); n_kinds = words(kinds)

# ---- from the CSV files: value[metric, scene, accelerator], time a ray with its interval ----

chosen(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
known(s, a, counter) = chosen(s, a) && strcol(counter) ne ""
place(m, s, a) = ((m - 1) * n_scenes + s - 1) * n_accels + a
n_metrics = 6
array value[n_metrics * n_scenes * n_accels]
array low[n_scenes * n_accels]; array high[n_scenes * n_accels]
array title[n_metrics] = ["object tests / ray", "extent tests / ray", "steps / ray", "ns / ray", "build, ms", "memory, MB"]

# A mean is over the same kinds of rays for all accelerators: unknown where one was left out.
array whole[n_scenes] # rays of all kinds
do for [s = 1:n_scenes] {
  whole[s] = 0
  do for [k = 1:n_kinds] {
    stats "times.csv" using (strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) ? column("set_rays") : 0) nooutput
    whole[s] = whole[s] + STATS_max
  }
  do for [a = 1:n_accels] {
    do for [m = 1:3] {
      counter = word("object_tests extent_tests steps", m)
      stats "times.csv" using (known(s, a, counter) ? column("set_rays") : 0) nooutput
      weight = STATS_sum
      stats "times.csv" using (known(s, a, counter) ? column(counter) / column("rays") * column("set_rays") : 0) nooutput
      value[place(m, s, a)] = weight > 0 && weight == whole[s] ? STATS_sum / weight : NaN
    }
    stats "times.csv" using (chosen(s, a) ? column("set_rays") : 0) nooutput
    timed = STATS_sum
    do for [name in "ns ns_low ns_high"] {
      stats "times.csv" using (chosen(s, a) ? column(name) * column("set_rays") : 0) nooutput
      mean = timed > 0 && timed == whole[s] ? STATS_sum / timed : NaN
      if (name eq "ns") { value[place(4, s, a)] = mean }
      if (name eq "ns_low") { low[place(1, s, a)] = mean }
      if (name eq "ns_high") { high[place(1, s, a)] = mean }
    }
    stats "times.csv" using (chosen(s, a) ? column("build_seconds") * 1e3 : 0) nooutput
    value[place(5, s, a)] = timed > 0 ? STATS_max : NaN
    stats "times.csv" using (chosen(s, a) ? column("bytes") * 1e-6 : 0) nooutput
    value[place(6, s, a)] = timed > 0 ? STATS_max : NaN
  }
}

# ---- the overview: points, one accelerator a line, the same line in every panel; a logarithm has no foot for bars ----

left = 0.115
panel_width = (0.995 - left) / n_metrics
array lowest[n_metrics] = [0.1, 0.1, 0.1, 1, 0.01, 0.001]
row_height = 46 + 20 * n_accels
height = 46 + row_height * n_scenes

eval canvas("1-overview", 960, height)
set multiplot
set logscale x
set yrange [n_accels + 0.6 : 0.4]
set format x "10^{%T}"
set grid xtics ytics linecolor rgb faint linetype 1 linewidth 0.5
set xtics scale 0.4 offset 0, 0.4 font ",11"
do for [s = 1:n_scenes] {
  do for [m = 1:n_metrics] {
    highest = lowest[m]
    do for [t = 1:n_scenes] {
      do for [a = 1:n_accels] {
        v = value[place(m, t, a)]
        if (v == v && v > highest) { highest = v }
      }
    }
    # room for the figure behind the last point
    set xrange [lowest[m] : lowest[m] * (highest / lowest[m]) ** 1.6]
    set xtics lowest[m], (highest / lowest[m] > 1e5 ? 1000 : 100), highest
    set lmargin at screen left + (m - 1) * panel_width + 0.012
    set rmargin at screen left + m * panel_width - 0.004
    set tmargin at screen 1 - (46.0 + row_height * (s - 1)) / height
    set bmargin at screen 1 - (46.0 + row_height * s - 36) / height
    unset label
    set ytics 1, 1, n_accels format "" scale 0
    if (m == 1) {
      set label 1 word(scenes, s) at screen 0.008, graph 1.03 left font ",15" textcolor rgb ink
      do for [a = 1:n_accels] {
        set label 100 + a word(accels, a) at graph -0.06, first a right textcolor rgb ink font ",13"
      }
    }
    if (s == 1) { set label 2 title[m] at graph 0, screen 1 - 24.0 / height left font ",13" textcolor rgb ink }
    do for [a = 1:n_accels] {
      v = value[place(m, s, a)]
      set label 200 + a figure(v) at first (v == v && v > lowest[m] ? v : lowest[m]), first a left offset character 0.8, 0 \
          textcolor rgb (v == v ? ink : soft) font ",12"
    }
    plot for [a = 1:n_accels] "+" using (value[place(m, s, a)] > lowest[m] ? value[place(m, s, a)] : NaN):(a) every ::0::0 \
           with points pointtype marker(a) pointsize 0.9 linecolor rgb color(a), \
         for [a = 1:n_accels] "+" using (m == 4 ? low[place(1, s, a)] : NaN):(a):(high[place(1, s, a)] - low[place(1, s, a)]):(0) every ::0::0 \
           with vectors nohead linewidth 1.5 linecolor rgb ink
  }
}
unset multiplot
unset output

# ---- time by ray kind: a group of points a kind, an accelerator a colour and marker, with its interval ----

reset session
load "plots/names.gp"
load "plots/style.gp"
n_scenes = words(scenes); n_accels = words(accels); n_kinds = words(kinds)
chosen(s, a) = strcol("scene") eq word(scenes, s) && strcol("accel") eq word(accels, a)
number(kind) = sum [k = 1:n_kinds] (word(kinds, k) eq kind ? k : 0)
x_of(a) = number(strcol("kind")) + (a - (n_accels + 1) / 2.0) * 0.8 / n_accels

array cells[n_scenes * n_kinds]
do for [s = 1:n_scenes] {
  do for [k = 1:n_kinds] {
    stats "times.csv" using (strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) ? 1 : 0) nooutput
    cells[(s - 1) * n_kinds + k] = STATS_sum > 0
  }
}

height = 70 + 240 * n_scenes
eval canvas("2-time-by-kind", 960, height)
set multiplot
set logscale y
set format y "10^{%T}"
set grid noxtics ytics
set xrange [0.5 : n_kinds + 0.5]
set yrange [10 : *]
set xtics scale 0 ()
do for [k = 1:n_kinds] { set xtics add (word(kinds, k) k) }
do for [s = 1:n_scenes] {
  set lmargin at screen 0.06
  set rmargin at screen 0.99
  set tmargin at screen 1 - (80 + 240.0 * (s - 1)) / height
  set bmargin at screen 1 - (20 + 240.0 * s) / height
  set label 1 word(scenes, s).", ns / ray" at graph 0, 1.08 left font ",15" textcolor rgb ink
  do for [k = 1:n_kinds] {
    note = cells[(s - 1) * n_kinds + k] ? "" : "no such rays"
    set label 10 + k note at first k, graph 0.06 center font ",12" textcolor rgb soft
    set arrow k from k + 0.5, graph 0 to k + 0.5, graph 1 nohead linecolor rgb faint linewidth 0.5
  }
  if (s == 1) {
    set key at screen 0.99, screen 1 - 12.0 / height right top horizontal samplen 0.5 maxrows 2 textcolor rgb ink width 1
  } else { unset key }
  plot for [a = 1:n_accels] "times.csv" using (chosen(s, a) ? x_of(a) : NaN):"ns":"ns_low":"ns_high" with yerrorbars \
         pointtype marker(a) pointsize 0.8 linewidth 1.2 linecolor rgb color(a) title word(accels, a)
}
unset multiplot
unset output
