# Written by raytally: cost over each swept parameter, over all ray kinds. For your own plots name
# gnuplot scripts under `plots` of the experiment.

reset session
load "plots/names.gp"; load "plots/style.gp"
set grid xtics ytics
$p1_1 << EOD
x,ns,low,high,object_tests,steps
100,165.626674,165.250669,166.470578,0.878394974,7.96173069
1000,354.614276,353.556553,356.16578,1.09168922,15.8147453
10000,681.369022,666.189296,694.688004,1.36186366,24.1669292
100000,1191.647,1162.54447,1229.84783,1.66961349,33.8006344
EOD
$p1_2 << EOD
x,ns,low,high,object_tests,steps
100,98.8925646,98.4594817,99.5927196,0.872140511,8.16138798
1000,196.46206,195.366982,198.567944,1.1125123,15.3508551
10000,363.283153,354.679336,369.066669,1.40577747,23.2995212
100000,677.096775,637.842707,705.215754,1.73690085,32.0785068
EOD
$p1_3 << EOD
x,ns,low,high,object_tests,steps
100,545.89787,545.058078,546.691267,90.7615669,0
1000,4882.77663,4873.60897,4900.3703,858.507713,0
10000,48195.3017,47842.2739,48718.4804,8191.80255,0
100000,441708.425,441267.354,446517.714,78002.0808,0
EOD
set style line 1 linecolor rgb "#cc79a7" dashtype 1 pointtype 7 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 2 linecolor rgb "#472a3a" dashtype 1 pointtype 5 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 3 linecolor rgb "#7f7f7f" dashtype 1 pointtype 9 pointsize 0.55 linewidth 1.6 pointinterval 1
set logscale x
set xrange [95.2380952:105000]
set format x "10^{%T}"

#: 01-sweep-n-time: Time per ray over n, a line per accelerator, a panel per scene.
#:   All kinds of rays together, medians with intervals. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("01-sweep-n-time", 480, 338)
set multiplot
set logscale y; set yrange [75.7380628:580473.029]; set ytics autofreq
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 3
set label 1 "brute" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 1
set label 2 "oriented" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 2
set label 3 "aligned" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "ns per ray" textcolor rgb ink; set format y "10^{%T}"
set xlabel "n" noenhanced textcolor rgb ink
order = "3 1 2 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:2 with linespoints linestyle int(word(order, i)) notitle, for [i = 1:words(order)] '$p1_'.word(order, i) using 1:3:(0):($4 - $3) with vectors heads size graph 0.01, 90 nofilled linestyle int(word(order, i)) dashtype 1 linewidth 1.6 notitle
unset arrow; unset label
unset multiplot
unset output

#: 02-sweep-n-object-tests: Object tests per ray over n, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("02-sweep-n-object-tests", 480, 338)
set multiplot
set logscale y; set yrange [0.670877316:101402.705]; set ytics autofreq
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 3
set label 1 "brute" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 2
set label 2 "aligned" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 1
set label 3 "oriented" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "object tests per ray" textcolor rgb ink; set format y "10^{%T}"
set xlabel "n" noenhanced textcolor rgb ink
order = "3 2 1 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:5 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output

#: 03-sweep-n-steps: Steps per ray over n, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("03-sweep-n-steps", 480, 338)
set multiplot
unset logscale y; set ytics autofreq; set yrange [0:35.8286725]
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 1
set label 1 "oriented" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 2
set label 2 "aligned" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 3
set label 3 "brute" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "steps per ray" textcolor rgb ink; set format y "%g"
set xlabel "n" noenhanced textcolor rgb ink
order = "1 2 3 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:6 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output

reset session
load "plots/names.gp"; load "plots/style.gp"
set grid xtics ytics
$p1_1 << EOD
x,ns,low,high,object_tests,steps
3,226.348478,225.507807,228.530365,1.63854587,12.4090222
4,318.532941,317.860957,319.230845,1.68118286,17.4935608
5,411.895004,410.564529,414.082642,1.72131348,21.3261414
6,534.610066,533.236306,537.286863,1.67778351,25.5530301
7,724.461714,719.211014,729.276098,1.79604454,30.15625
8,912.545797,903.486688,938.343813,1.7949375,33.3222813
EOD
$p1_2 << EOD
x,ns,low,high,object_tests,steps
3,134.790324,133.770739,137.4643,2.54671749,13.9632686
4,182.750041,181.8584,184.976967,2.54559326,19.2817383
5,232.791547,232.055817,234.329926,2.78466797,23.9128418
6,310.064364,306.580114,311.107926,2.8352502,28.4122842
7,450.849225,444.986005,456.149068,3.1363189,34.5078433
8,587.569883,566.000406,604.743438,3.08628125,38.4006562
EOD
$p1_3 << EOD
x,ns,low,high,object_tests,steps
3,490.865106,488.300467,494.388748,108.705519,0
4,1785.83547,1779.85556,1793.39387,422.20061,0
5,6926.25539,6911.36789,6939.40041,1681.01707,0
6,26759.4743,26728.8474,26810.8087,6553.37008,0
7,107115.169,106925.412,107433.383,26099.1702,0
8,428787.135,427934.697,435803.296,104489.088,0
EOD
set style line 1 linecolor rgb "#cc79a7" dashtype 1 pointtype 7 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 2 linecolor rgb "#472a3a" dashtype 1 pointtype 5 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 3 linecolor rgb "#7f7f7f" dashtype 1 pointtype 9 pointsize 0.55 linewidth 1.6 pointinterval 1
set xrange [2.9:8.1]
set xtics ("3" 3,"4" 4,"5" 5,"6" 6,"7" 7,"8" 8)

#: 04-sweep-size-time: Time per ray over size, a line per accelerator, a panel per scene.
#:   All kinds of rays together, medians with intervals. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("04-sweep-size-time", 480, 338)
set multiplot
set logscale y; set yrange [102.900568:566544.285]; set ytics autofreq
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 3
set label 1 "brute" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 1
set label 2 "oriented" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 2
set label 3 "aligned" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "mount" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "ns per ray" textcolor rgb ink; set format y "10^{%T}"
set xlabel "size" noenhanced textcolor rgb ink
order = "3 1 2 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:2 with linespoints linestyle int(word(order, i)) notitle, for [i = 1:words(order)] '$p1_'.word(order, i) using 1:3:(0):($4 - $3) with vectors heads size graph 0.01, 90 nofilled linestyle int(word(order, i)) dashtype 1 linewidth 1.6 notitle
unset arrow; unset label
unset multiplot
unset output

#: 05-sweep-size-object-tests: Object tests per ray over size, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("05-sweep-size-object-tests", 480, 338)
set multiplot
set logscale y; set yrange [1.2604199:135835.815]; set ytics autofreq
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 3
set label 1 "brute" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 2
set label 2 "aligned" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 1
set label 3 "oriented" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "mount" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "object tests per ray" textcolor rgb ink; set format y "10^{%T}"
set xlabel "size" noenhanced textcolor rgb ink
order = "3 2 1 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:5 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output

#: 06-sweep-size-steps: Steps per ray over size, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("06-sweep-size-steps", 480, 338)
set multiplot
unset logscale y; set ytics autofreq; set yrange [0:40.7046956]
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 2
set label 1 "aligned" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 1
set label 2 "oriented" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 3
set label 3 "brute" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "mount" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "steps per ray" textcolor rgb ink; set format y "%g"
set xlabel "size" noenhanced textcolor rgb ink
order = "2 1 3 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:6 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output
