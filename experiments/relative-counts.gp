# SPDX-License-Identifier: Apache-2.0
# relative-counts: expected cost, object tests and steps over those of the first accelerator, a row per accelerator.
#: 2-counts: Expected cost, object tests and steps per ray over those of the first accelerator, on logarithmic scales.
#:   All ray kinds together, one marker per scene; left of 1 there are fewer.

n_scenes = words(scenes)
first = word(accels, 1)
shown = ""
do for [a = 2:words(accels)] { shown = shown.word(accels, a)." " }
n_shown = words(shown)
row(name) = sum [i = 1:n_shown] (word(shown, i) eq name ? n_shown + 1 - i : 0)
shift(s) = 0.7 / n_scenes * (0.5 * (n_scenes + 1) - s)

# A row per scene and accelerator. Only `spec` has commas within quotes, so columns behind it are counted from the end.
table = "< awk -F, -v first='".first."' '\
NR == 1 { for (i = 1; i <= NF; i++) { at[$i] = i; back[$i] = NF - i } print \"scene,accel,predicted_cost,object_tests,steps\"; next } \
{ key = $at[\"scene\"] SUBSEP $at[\"accel\"]; if (!(key in rays)) order[++n] = key; rays[key] += $(NF - back[\"rays\"]); \
cost[key] = $(NF - back[\"predicted_cost\"]); tests[key] += $(NF - back[\"object_tests\"]); steps[key] += $(NF - back[\"steps\"]) } \
function over(a, b) { return a == \"\" || b + 0 == 0 || a + 0 == 0 ? \"NaN\" : a / b } \
END { for (i = 1; i <= n; i++) { split(order[i], k, SUBSEP); f = k[1] SUBSEP first; if (!(f in rays)) continue; \
r = rays[order[i]] / rays[f]; print k[1] \",\" k[2] \",\" over(cost[order[i]], cost[f]) \",\" over(tests[order[i]] / r, tests[f]) \",\" \
over(steps[order[i]] / r, steps[f]) } }' counts.csv"

counters = "predicted_cost object_tests steps"
titles = "'expected cost' 'object tests' 'steps'"
key_rows = 1 + (strlen(scenes) - 1) / 80
head = 44.0 + 20 * key_rows
height = head + 66 + n_shown * (18 + 4 * n_scenes)
set logscale x 2
set yrange [0.4 : n_shown + 0.6]
set grid ytics
set format x "%g"
set xlabel "over that of ".first noenhanced textcolor rgb ink

eval canvas("2-counts", 960, height)
set multiplot layout 1, 3 margins screen 0.17, 0.985, 48.0 / height, 1 - head / height spacing screen 0.025, 0
do for [c = 1:3] {
  set title word(titles, c) font ",14" textcolor rgb ink
  set ytics () noenhanced
  do for [i = 1:n_shown] { set ytics add ((c == 1 ? word(shown, i) : "") n_shown + 1 - i) }
  if (c == 1) {
    set key at screen 0.985, screen 1 - 6.0 / height right top vertical maxrows key_rows samplen 1 textcolor rgb ink noenhanced
  } else { unset key }
  set arrow 1 from 1, graph 0 to 1, graph 1 nohead linewidth 1.5 dashtype 2 linecolor rgb soft
  plot for [s = 1:n_scenes] table \
         using (strcol("scene") eq word(scenes, s) && row(strcol("accel")) > 0 ? column(word(counters, c)) : NaN): \
               (row(strcol("accel")) + shift(s)) \
         with points linewidth 1.4 pointtype mark(s) pointsize 0.7 linecolor rgb hue(s) title word(scenes, s)
}
unset multiplot
unset output
