# Written by raytally: cost over each swept parameter, over all ray kinds. For your own plots name
# gnuplot scripts under `plots` of the experiment.

reset session
load "plots/names.gp"; load "plots/style.gp"
set grid xtics ytics
$p1_1 << EOD
x,ns,low,high,object_tests,steps
100,118.311811,115.887969,119.126273,5.16687242,7.23487735
1000,228.628335,226.942119,229.478257,8.06686581,13.5109145
10000,455.585109,444.295618,467.911827,9.85803373,22.6779459
100000,983.01883,886.619801,1058.65859,10.1448063,29.1316021
1000000,2151.5793,2056.13158,2247.46987,10.9720141,37.8087008
EOD
$p1_2 << EOD
x,ns,low,high,object_tests,steps
100,109.127687,108.766335,109.378952,4.20143846,4.42595674
1000,181.266401,180.530302,182.36669,6.10615809,6.83731618
10000,327.555027,317.855124,338.409251,7.38013123,9.78450193
100000,745.314137,643.687252,805.399153,7.4709507,11.2516505
1000000,1714.25171,1566.52526,1885.593,7.94199486,13.1116224
EOD
$p1_3 << EOD
x,ns,low,high,object_tests,steps
100,68.0666661,67.5650737,69.3568372,0.950458913,7.05893403
1000,131.621525,130.208304,132.526771,1.17543658,12.4954044
10000,246.757304,243.963597,250.923925,1.4385337,18.3586573
100000,506.613877,450.151216,585.346024,1.51386444,21.9673195
1000000,1069.4543,1026.58856,1243.49946,1.65421661,26.1653467
EOD
set style line 1 linecolor rgb "#56b4e9" dashtype 1 pointtype 7 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 2 linecolor rgb "#1e3f52" dashtype 1 pointtype 5 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 3 linecolor rgb "#d55e00" dashtype 1 pointtype 9 pointsize 0.55 linewidth 1.6 pointinterval 1
set logscale x
set xrange [95.2380952:1050000]
set format x "10^{%T}"

#: 01-sweep-n-time: Time per ray over n, a line per accelerator, a panel per scene.
#:   All kinds of rays together, medians with intervals. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("01-sweep-n-time", 480, 338)
set multiplot
set logscale y; set yrange [51.9731336:2921.71084]; set ytics autofreq
set ytics (100,200,500,1000,2000)
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 1
set label 1 "glassner" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 2
set label 2 "octree" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 3
set label 3 "bvh" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "ns per ray" textcolor rgb ink; set format y "%g"
set xlabel "n" noenhanced textcolor rgb ink
order = "1 2 3 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:2 with linespoints linestyle int(word(order, i)) notitle, for [i = 1:words(order)] '$p1_'.word(order, i) using 1:3:(0):($4 - $3) with vectors heads size graph 0.01, 90 nofilled linestyle int(word(order, i)) dashtype 1 linewidth 1.6 notitle
unset arrow; unset label
unset multiplot
unset output

#: 02-sweep-n-object-tests: Object tests per ray over n, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("02-sweep-n-object-tests", 480, 338)
set multiplot
set logscale y; set yrange [0.73112224:14.2636184]; set ytics autofreq
set ytics (1,2,5,10)
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 1
set label 1 "glassner" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 2
set label 2 "octree" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 3
set label 3 "bvh" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "object tests per ray" textcolor rgb ink; set format y "%g"
set xlabel "n" noenhanced textcolor rgb ink
order = "1 2 3 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:5 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output

#: 03-sweep-n-steps: Steps per ray over n, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("03-sweep-n-steps", 480, 338)
set multiplot
unset logscale y; set ytics autofreq; set yrange [0:40.0772228]
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 1
set label 1 "glassner" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 3
set label 2 "bvh" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 2
set label 3 "octree" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "steps per ray" textcolor rgb ink; set format y "%g"
set xlabel "n" noenhanced textcolor rgb ink
order = "1 3 2 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:6 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output

reset session
load "plots/names.gp"; load "plots/style.gp"
set grid xtics ytics
$p1_1 << EOD
x,ns,low,high,object_tests,steps
3,299.867183,298.219088,300.938802,14.7768965,22.0956584
4,524.365912,516.771858,530.724058,16.9770435,38.8748221
5,873.384894,865.709593,880.358607,18.6133453,59.690958
6,1080.09815,1066.61563,1115.4585,23.8119939,68.7519584
7,1822.41963,1792.16346,1850.4537,24.1484476,95.7584754
8,2941.72936,2860.10168,3027.07363,23.9873251,124.425544
9,3581.05544,3493.44859,3719.75832,47.756307,132.686347
EOD
$p1_2 << EOD
x,ns,low,high,object_tests,steps
3,166.129995,165.302034,166.658278,5.24135258,10.3295563
4,259.673979,253.85925,263.447518,5.94431038,15.6273127
5,376.439352,370.709529,387.330131,6.41483094,21.4143186
6,496.93014,485.73797,510.810743,8.81627279,23.6528207
7,850.744242,835.350499,875.065629,8.8378966,30.0826143
8,1388.12505,1366.42984,1438.53726,8.82982408,35.9991689
9,1909.69748,1808.25143,1955.87799,21.0766377,38.3261607
EOD
$p1_3 << EOD
x,ns,low,high,object_tests,steps
3,55.837578,55.5885634,56.3400402,2.92789838,3.91471851
4,63.7639347,62.1882685,64.8871389,2.75044861,5.36581895
5,71.076999,70.5286713,73.1876814,2.67584529,6.8359375
6,89.0824087,87.789157,90.5253681,2.57573563,8.23579751
7,113.355766,109.913454,115.906393,2.49045451,9.65452816
8,156.591368,152.042163,176.747272,2.42145727,11.0024242
9,396.857653,379.451152,436.185563,2.92887428,14.2641509
EOD
$p2_1 << EOD
x,ns,low,high,object_tests,steps
2,686.912725,684.842229,689.552013,24.9870491,72.4674392
3,1240.78276,1239.39825,1243.15001,33.4562282,137.956723
4,1701.60596,1672.18854,1731.31286,44.5796875,182.880208
5,2335.93276,2319.38844,2365.2388,62.1511458,238.813125
EOD
$p2_2 << EOD
x,ns,low,high,object_tests,steps
2,345.833014,345.269033,346.829147,12.2310717,27.375
3,528.959109,527.421685,530.516372,14.2913082,46.0232546
4,706.203411,692.440052,721.351146,20.5032292,56.2663021
5,998.80888,984.066406,1019.36208,32.3178646,68.2823958
EOD
$p2_3 << EOD
x,ns,low,high,object_tests,steps
2,64.8377934,64.3181271,65.2275685,0.971004614,7.20564178
3,88.9228701,86.5596374,90.2761329,1.05271391,9.7230304
4,141.991582,138.922227,151.602656,1.23223958,12.2665104
5,187.075634,179.15053,200.544362,1.10348958,13.6344271
EOD
set style line 1 linecolor rgb "#56b4e9" dashtype 1 pointtype 7 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 2 linecolor rgb "#1e3f52" dashtype 1 pointtype 5 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 3 linecolor rgb "#d55e00" dashtype 1 pointtype 9 pointsize 0.55 linewidth 1.6 pointinterval 1
set xrange [1.86:9.14]
set xtics ("2" 2,"3" 3,"4" 4,"5" 5,"6" 6,"7" 7,"8" 8,"9" 9)

#: 04-sweep-size-time: Time per ray over size, a line per accelerator, a panel per scene.
#:   All kinds of rays together, medians with intervals. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("04-sweep-size-time", 960, 338)
set multiplot
set logscale y; set yrange [42.7604334:4835.68582]; set ytics autofreq
set arrow 1 from screen 0.0125, screen 0.0414 to screen 0.0458, screen 0.0414 nohead linestyle 1
set label 1 "glassner" at screen 0.0292, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0229, 0 textcolor rgb ink
set arrow 2 from screen 0.1750, screen 0.0414 to screen 0.2083, screen 0.0414 nohead linestyle 2
set label 2 "octree" at screen 0.1917, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0229, 0 textcolor rgb ink
set arrow 3 from screen 0.3375, screen 0.0414 to screen 0.3708, screen 0.0414 nohead linestyle 3
set label 3 "bvh" at screen 0.3542, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0229, 0 textcolor rgb ink
set lmargin at screen 0.0875; set rmargin at screen 0.5188; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "tetra" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "ns per ray" textcolor rgb ink; set format y "%g"
set xlabel "size" noenhanced textcolor rgb ink
order = "1 2 3 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:2 with linespoints linestyle int(word(order, i)) notitle, for [i = 1:words(order)] '$p1_'.word(order, i) using 1:3:(0):($4 - $3) with vectors heads size graph 0.01, 90 nofilled linestyle int(word(order, i)) dashtype 1 linewidth 1.6 notitle
unset arrow; unset label
set lmargin at screen 0.5437; set rmargin at screen 0.9750; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "balls" noenhanced textcolor rgb ink offset 0, -0.4
unset ylabel; set format y ""
set xlabel "size" noenhanced textcolor rgb ink
order = "1 2 3 "
plot for [i = 1:words(order)] '$p2_'.word(order, i) using 1:2 with linespoints linestyle int(word(order, i)) notitle, for [i = 1:words(order)] '$p2_'.word(order, i) using 1:3:(0):($4 - $3) with vectors heads size graph 0.01, 90 nofilled linestyle int(word(order, i)) dashtype 1 linewidth 1.6 notitle
unset arrow; unset label
unset multiplot
unset output

#: 05-sweep-size-object-tests: Object tests per ray over size, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("05-sweep-size-object-tests", 960, 338)
set multiplot
set logscale y; set yrange [0.746926626:80.7964896]; set ytics autofreq
set arrow 1 from screen 0.0125, screen 0.0414 to screen 0.0458, screen 0.0414 nohead linestyle 1
set label 1 "glassner" at screen 0.0292, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0229, 0 textcolor rgb ink
set arrow 2 from screen 0.1750, screen 0.0414 to screen 0.2083, screen 0.0414 nohead linestyle 2
set label 2 "octree" at screen 0.1917, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0229, 0 textcolor rgb ink
set arrow 3 from screen 0.3375, screen 0.0414 to screen 0.3708, screen 0.0414 nohead linestyle 3
set label 3 "bvh" at screen 0.3542, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0229, 0 textcolor rgb ink
set lmargin at screen 0.0875; set rmargin at screen 0.5188; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "tetra" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "object tests per ray" textcolor rgb ink; set format y "%g"
set xlabel "size" noenhanced textcolor rgb ink
order = "1 2 3 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:5 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
set lmargin at screen 0.5437; set rmargin at screen 0.9750; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "balls" noenhanced textcolor rgb ink offset 0, -0.4
unset ylabel; set format y ""
set xlabel "size" noenhanced textcolor rgb ink
order = "1 2 3 "
plot for [i = 1:words(order)] '$p2_'.word(order, i) using 1:5 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output

#: 06-sweep-size-steps: Steps per ray over size, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("06-sweep-size-steps", 960, 338)
set multiplot
set logscale y; set yrange [3.01132193:310.457063]; set ytics autofreq
set arrow 1 from screen 0.0125, screen 0.0414 to screen 0.0458, screen 0.0414 nohead linestyle 1
set label 1 "glassner" at screen 0.0292, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0229, 0 textcolor rgb ink
set arrow 2 from screen 0.1750, screen 0.0414 to screen 0.2083, screen 0.0414 nohead linestyle 2
set label 2 "octree" at screen 0.1917, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0229, 0 textcolor rgb ink
set arrow 3 from screen 0.3375, screen 0.0414 to screen 0.3708, screen 0.0414 nohead linestyle 3
set label 3 "bvh" at screen 0.3542, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0229, 0 textcolor rgb ink
set lmargin at screen 0.0875; set rmargin at screen 0.5188; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "tetra" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "steps per ray" textcolor rgb ink; set format y "%g"
set xlabel "size" noenhanced textcolor rgb ink
order = "1 2 3 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:6 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
set lmargin at screen 0.5437; set rmargin at screen 0.9750; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "balls" noenhanced textcolor rgb ink offset 0, -0.4
unset ylabel; set format y ""
set xlabel "size" noenhanced textcolor rgb ink
order = "1 2 3 "
plot for [i = 1:words(order)] '$p2_'.word(order, i) using 1:6 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output
