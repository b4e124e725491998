# SPDX-License-Identifier: Apache-2.0
# extent-cost: time of each kind of extent over that of boxes, by the size of objects; and measured times over those of the formula.
#: 1-crossing: Time per ray of each kind of extent over that of boxes, over the mean radius of objects, with intervals.
#:   Below 1 the tighter extent pays. One column for each kind of rays.
#: 2-formula: Measured time per ray over b B + i I, by the measured time. The constants B and I of each kind of extent are fitted to all
#:   of its cells, and are listed in plots/2-formula.csv.

shapes = "spheres triangles"
of(shape) = strcol("scene")[1:strlen(shape)] eq shape
row(shape, k, a) = of(shape) && strcol("kind") eq word(kinds, k) && strcol("accel") eq word(accels, a)

eval canvas("1-crossing", 960, 590)
set multiplot layout 2, words(kinds) margins screen 0.075, 0.985, 0.1, 0.87 spacing screen 0.035, 0.13
set logscale xy 2
set grid xtics ytics
set xrange [0.2 : 10]
set yrange [0.5 : 8]
set ytics (0.5, 1, 2, 4, 8)
do for [s = 1:words(shapes)] {
  shape = word(shapes, s)
  if (s == words(shapes)) { set xlabel "mean radius, in mean spacings" textcolor rgb ink }
  do for [k = 1:words(kinds)] {
    set title shape.", ".word(kinds, k)." rays" font ",13" textcolor rgb ink
    if (k == 1) { set ylabel "time, boxes being 1" textcolor rgb ink } else { unset ylabel }
    if (s == 1 && k == 1) { set key at screen 0.985, screen 0.985 right top vertical maxrows 1 samplen 2 textcolor rgb ink } else { unset key }
    plot 1 with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
         for [a = 2:words(accels)] "times.csv" using (row(shape, k, a) ? column("scene.radius") : NaN):(1 / column("ratio")): \
           (1 / column("ratio_high")):(1 / column("ratio_low")) with yerrorlines linewidth 1.8 pointtype mark(a) pointsize 0.7 \
           linecolor rgb hue(a) title word(accels, a)
  }
}
unset multiplot
unset output

# The formula, fitted with relative errors: each cell counts alike.
unset logscale
set xrange [*:*]
set yrange [*:*]
set fit quiet nolog
array fitted_B[words(accels)]; array fitted_I[words(accels)]
formula(b, i) = B * b + I * i
set print "plots/2-formula.csv"
print "extent,B_ns,I_ns"
do for [a = 1:words(accels)] {
  B = 2; I = 14
  fit formula(x, y) "times.csv" using (strcol("accel") eq word(accels, a) ? column("extent_tests") / column("rays") : NaN): \
    (column("object_tests") / column("rays")):(column("ns")):(column("ns")) zerror via B, I
  fitted_B[a] = B; fitted_I[a] = I
  print sprintf("%s,%.2f,%.1f", word(accels, a), B, I)
}
unset print

eval canvas("2-formula", 480, 400)
unset title
set logscale x 10
set xrange [1500 : 15000]
set xtics (2000, 5000, 10000)
set yrange [0 : 2]
set ytics 0.5
set xlabel "measured time, ns per ray" textcolor rgb ink
set ylabel "measured / formula" textcolor rgb ink
set key inside top left vertical maxrows 2 samplen 1 textcolor rgb ink
plot 1 with lines linewidth 1.5 dashtype 2 linecolor rgb soft notitle, \
     for [a = 1:words(accels)] "times.csv" using (strcol("accel") eq word(accels, a) ? column("ns") : NaN): \
       (column("ns") / (fitted_B[a] * column("extent_tests") / column("rays") + fitted_I[a] * column("object_tests") / column("rays"))) \
       with points pointtype mark(a) pointsize 0.7 linecolor rgb hue(a) title word(accels, a)
unset output
