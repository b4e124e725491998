# SPDX-License-Identifier: Apache-2.0
# overlays: time of a frame with each combination of overlays over that of the structure alone.
#: frame: Time of a frame with each combination of overlays, over that of the structure below them alone.
#:   Intervals combine those of the kinds of rays. A cross marks the sum of what each overlay saves by itself, where it leaves any time.

bases = "octree grid bvh wide"
stacks = "item light cache item+light item+cache cache+light item+cache+light"
named(s, label) = strcol("scene") eq word(scenes, s) && strcol("accel") eq label
array alone[words(scenes) * words(bases)]
array saved[words(scenes) * words(bases) * 3]
do for [s = 1:words(scenes)] {
  do for [b = 1:words(bases)] {
    n = (s - 1) * words(bases) + b
    stats "frame.csv" using (named(s, word(bases, b)) ? column("ms") : NaN) nooutput
    alone[n] = STATS_mean
    do for [o = 1:3] {
      stats "frame.csv" using (named(s, word(stacks, o)."+".word(bases, b)) ? column("ms") : NaN) nooutput
      saved[3 * (n - 1) + o] = 1 - STATS_mean / alone[n]
    }
  }
}
has(stack, o) = strstrt("+".stack."+", "+".word(stacks, o)."+") > 0
sum_of(n, stack) = 1 - (sum [o = 1:3] (has(stack, o) ? saved[3 * (n - 1) + o] : 0))

eval canvas("frame", 960, 420)
set multiplot layout 1, words(scenes) margins screen 0.085, 0.985, 0.28, 0.79 spacing screen 0.02, 0.1
set xrange [0.5 : words(stacks) + 0.5]
set logscale y
set yrange [0.005 : 7]
set ytics (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5)
set grid ytics
set xtics rotate by 40 right
do for [i = 1:words(stacks)] { set xtics add (word(stacks, i) i) }
do for [s = 1:words(scenes)] {
  set title word(scenes, s) font ",13" textcolor rgb ink
  if (s == 1) {
    set ylabel "frame, without overlays 1" textcolor rgb ink
    set key at screen 0.985, screen 0.985 right top vertical maxrows 2 samplen 1 textcolor rgb ink
  } else { unset ylabel; set format y ""; unset key }
  plot 1 with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
       for [b = 1:words(bases)] NaN with points pointtype mark(b) linecolor rgb hue(b) title "over ".word(bases, b), \
       NaN with points pointtype 2 linecolor rgb ink title "sum of single savings", \
       for [b = 1:words(bases)] for [i = 1:words(stacks)] n = (s - 1) * words(bases) + b \
         "frame.csv" using (named(s, word(stacks, i)."+".word(bases, b)) ? i + 0.16 * (b - 2.5) : NaN):(column("ms") / alone[n]): \
         (column("ms_low") / alone[n]):(column("ms_high") / alone[n]) with yerrorbars linewidth 1.5 pointtype mark(b) pointsize 0.8 linecolor rgb hue(b) notitle, \
       for [b = 1:words(bases)] for [i = 4:words(stacks)] n = (s - 1) * words(bases) + b \
         "frame.csv" using (named(s, word(stacks, i)."+".word(bases, b)) ? i + 0.16 * (b - 2.5) : NaN):(sum_of(n, word(stacks, i))) \
         with points pointtype 2 pointsize 0.8 linecolor rgb ink notitle
}
unset multiplot
unset output
