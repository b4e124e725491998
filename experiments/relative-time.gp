# SPDX-License-Identifier: Apache-2.0
# relative-time: time per ray over that of the baseline, a row per accelerator, a panel per ray kind.
#: 1-time: Time per ray over that of the baseline, one panel per ray kind, all on one logarithmic scale, a row per accelerator.
#:   Medians with intervals, one marker per scene; left of 1 it is faster than the baseline.

set datafile separator tab
table = tsv("times.csv")
n_scenes = words(scenes); n_kinds = words(kinds)
shown = ""
do for [a = 1:words(accels)] { if (word(accels, a) ne baseline) { shown = shown.word(accels, a)." " } }
n_shown = words(shown)
row(name) = sum [i = 1:n_shown] (word(shown, i) eq name ? n_shown + 1 - i : 0)
shift(s) = 0.7 / n_scenes * (0.5 * (n_scenes + 1) - s)
on(s, k) = strcol("scene") eq word(scenes, s) && strcol("kind") eq word(kinds, k) && row(strcol("accel")) > 0

panel_columns = across(2, n_kinds)
panel_rows = (n_kinds + panel_columns - 1) / panel_columns
longest = 0
do for [scene in scenes] { if (strlen(scene) > longest) { longest = strlen(scene) } }
key_rows = (n_scenes - 1) / int((wide - 20) / (42 + 9 * longest)) + 1
panel_height = 40 + n_shown * (18 + 4 * n_scenes)
head = 44.0 + 20 * key_rows
height = head + 2 + (panel_height + 68) * panel_rows
stats table using (row(strcol("accel")) > 0 ? 1 / column("ratio_high") : NaN) nooutput
low = STATS_min / 1.1
stats table using (row(strcol("accel")) > 0 ? 1 / column("ratio_low") : NaN) nooutput
high = STATS_max * 1.1
set logscale x 2
set xrange [low : high]
set yrange [0.4 : n_shown + 0.6]
set grid ytics
eval "set xtics rotate by 0 ".ratio_tics(low, high)

eval canvas("1-time", wide, height)
set multiplot layout panel_rows, panel_columns margins screen 163.0 / wide, 0.985, 58.0 / height, 1 - head / height \
    spacing screen 0.03, 68.0 / height
do for [k = 1:n_kinds] {
  set title word(kinds, k) font ",14" textcolor rgb ink
  set ytics () noenhanced
  do for [i = 1:n_shown] { set ytics add ((k % panel_columns == 1 % panel_columns ? word(shown, i) : "") n_shown + 1 - i) }
  if (k == 1) {
    set key at screen 0.985, screen 1 - 6.0 / height right top vertical maxrows key_rows samplen 1 textcolor rgb ink noenhanced
  } else { unset key }
  if (k > n_kinds - panel_columns) { set xlabel "time / ".baseline noenhanced textcolor rgb ink } else { unset xlabel }
  plot sample [t = 0.4 : n_shown + 0.6] "+" using (1):(t) with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
       for [s = 1:n_scenes] table \
         using (on(s, k) ? 1 / column("ratio") : NaN):(row(strcol("accel")) + shift(s)): \
               (1 / column("ratio_high")):(1 / column("ratio_low")) \
         with xerrorbars linewidth 1.4 pointtype mark(s) pointsize 0.6 linecolor rgb hue(s) title word(scenes, s)
}
unset multiplot
unset output
