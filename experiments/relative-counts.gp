# SPDX-License-Identifier: Apache-2.0
# relative-counts: expected cost, object tests and steps over those of the first accelerator in counts.csv, a row per accelerator.
#: 2-counts: Expected cost, object tests and steps per ray over those of the first accelerator, on one logarithmic scale.
#:   All ray kinds together, one marker per scene; left of 1 there are fewer.

set datafile separator tab
n_scenes = words(scenes)
# Those that are counted, in order: the best of several has no counts of its own.
counted = system(tsv("counts.csv")[3:*]." | awk -F '\t' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next } \
!seen[$at[\"accel\"]]++ { printf \"%s \", $at[\"accel\"] }'")
first = word(counted, 1)
shown = ""
do for [accel in accels] { if (accel ne first && strstrt(" ".counted." ", " ".accel." ")) { shown = shown.accel." " } }
n_shown = words(shown)
row(name) = sum [i = 1:n_shown] (word(shown, i) eq name ? n_shown + 1 - i : 0)
shift(s) = 0.7 / n_scenes * (0.5 * (n_scenes + 1) - s)

# A row per scene and accelerator.
table = tsv("counts.csv")." | awk -F '\t' -v OFS='\t' -v first='".first."' -v sets='".sets."' '\
BEGIN { m = split(sets, list, \" \"); \
for (i = 1; i <= m; i++) { end = match(list[i], \"=[0-9]+$\"); weights[substr(list[i], 1, end - 1)] = substr(list[i], end + 1) } } \
function over(a, b) { return a + 0 == 0 || b + 0 == 0 ? \"NaN\" : a / b } \
NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; print \"scene\", \"accel\", \"predicted_cost\", \"object_tests\", \"steps\"; next } \
{ key = $at[\"scene\"] SUBSEP $at[\"accel\"]; if (!(key in rays)) order[++n] = key; \
weight = weights[$at[\"scene\"] \"/\" $at[\"kind\"]]; rays[key] += weight; weight /= $at[\"rays\"]; \
cost[key] = $at[\"predicted_cost\"]; tests[key] += weight * $at[\"object_tests\"]; steps[key] += weight * $at[\"steps\"] } \
END { for (i = 1; i <= n; i++) { o = order[i]; split(o, k, SUBSEP); f = k[1] SUBSEP first; if (!(f in rays)) continue; \
print k[1], k[2], over(cost[o], cost[f]), over(tests[o] / rays[o], tests[f] / rays[f]), \
over(steps[o] / rays[o], steps[f] / rays[f]) } }'"

counters = "predicted_cost object_tests steps"
titles = "'expected cost' 'object tests' 'steps'"
longest = 0
do for [scene in scenes] { if (strlen(scene) > longest) { longest = strlen(scene) } }
key_rows = (n_scenes - 1) / int(940 / (42 + 9 * longest)) + 1
head = 44.0 + 20 * key_rows
height = head + 76 + n_shown * (18 + 4 * n_scenes)
set logscale x 2
set grid ytics
set xrange [*:*]; set yrange [*:*] # that relative-time.gp may have set
low = 1; high = 1 # the same scale for all
do for [c = 1:3] {
  stats table using (row(strcol("accel")) > 0 && column(word(counters, c)) > 0 ? column(word(counters, c)) : 1) nooutput
  if (STATS_min < low) { low = STATS_min }
  if (STATS_max > high) { high = STATS_max }
}
set xrange [low / 1.1 : high * 1.1]
set yrange [0.4 : n_shown + 0.6]
eval "set xtics ".ratio_tics(low / 1.1, high * 1.1)
set xlabel "over that of ".first noenhanced textcolor rgb ink

eval canvas("2-counts", 960, height)
set multiplot layout 1, 3 margins screen 0.17, 0.985, 58.0 / height, 1 - head / height spacing screen 0.025, 0
do for [c = 1:3] {
  set title word(titles, c) font ",14" textcolor rgb ink
  set ytics () noenhanced
  do for [i = 1:n_shown] { set ytics add ((c == 1 ? word(shown, i) : "") n_shown + 1 - i) }
  if (c == 1) {
    set key at screen 0.985, screen 1 - 6.0 / height right top vertical maxrows key_rows samplen 1 textcolor rgb ink noenhanced
  } else { unset key }
  plot sample [t = 0.4 : n_shown + 0.6] "+" using (1):(t) with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
       for [s = 1:n_scenes] table \
         using (strcol("scene") eq word(scenes, s) && row(strcol("accel")) > 0 ? column(word(counters, c)) : NaN): \
               (row(strcol("accel")) + shift(s)) \
         with points linewidth 1.4 pointtype mark(s) pointsize 0.7 linecolor rgb hue(s) title word(scenes, s)
}
unset multiplot
unset output
