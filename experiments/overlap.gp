# SPDX-License-Identifier: Apache-2.0
# overlap: bushes that overlap, as copies and as instances of one part, of eight and of sixty-four.
#: 1-overlap: Steps, instances entered and time of a ray over the spacing of bushes in diameters, in bvh (above) and wide (below), for
#:   random rays. Logarithmic axes; times with intervals.

bushes = "copies whole eighths small"
array names[4] = ["copies", "one part", "8 parts", "64 parts"]
spacing(s, a) = strcol("scene")[1:strlen(word(bushes, s)) + 1] eq word(bushes, s).":" && strcol("accel") eq word("bvh wide", a) && \
                strcol("kind") eq "random" ? real(strcol("scene")[strstrt(strcol("scene"), "=") + 1:*]) : NaN
amount(m) = m == 1 ? column("steps") / column("rays") : m == 2 ? column("instances_entered") / column("rays") : column("ns")
low(m) = m == 3 ? column("ns_low") : amount(m)
high(m) = m == 3 ? column("ns_high") : amount(m)
array heading[3] = ["steps a ray", "instances entered by a ray", "ns a ray"]

set logscale xy
set grid xtics ytics
set xrange [0.2 : 2.5]
set xtics (0.25, 0.5, 1, 2)
eval canvas("1-overlap", 960, 560)
set multiplot layout 2, 3 margins screen 0.06, 0.985, 0.1, 0.86 spacing screen 0.06, 0.16
do for [a = 1:2] { do for [m = 1:3] {
  set title word("bvh wide", a).": ".heading[m] font ",13" textcolor rgb ink
  if (a == 2) { set xlabel "spacing, diameters" textcolor rgb ink } else { unset xlabel }
  if (a + m == 2) { set key at screen 0.985, screen 0.985 right top vertical maxrows 1 samplen 2 textcolor rgb ink } else { unset key }
  plot for [s = (m == 2 ? 2 : 1):4] (m == 2 ? "counts.csv" : "times.csv") using (spacing(s, a)):(amount(m)):(low(m)):(high(m)) with yerrorlines \
    linewidth 1.5 pointtype mark(s) pointsize 0.7 linecolor rgb hue(s) title names[s]
} }
unset multiplot
unset output
