# Written by raytally: cost over each swept parameter, over all ray kinds. For your own plots name
# gnuplot scripts under `plots` of the experiment.

reset session
load "plots/names.gp"; load "plots/style.gp"
set grid xtics ytics
$p1_1 << EOD
x,ns,low,high,object_tests,steps
100,168.967668,167.206592,172.312705,0.878394974,7.96173069
1000,372.785943,360.742157,383.831503,1.09168922,15.8147453
10000,724.82581,694.638499,773.944478,1.36186366,24.1669292
100000,1403.34838,1365.61052,1454.20157,1.66961349,33.8006344
EOD
$p1_2 << EOD
x,ns,low,high,object_tests,steps
100,100.53759,99.7453782,102.542744,0.872140511,8.16138798
1000,203.710644,200.682335,207.376263,1.1125123,15.3508551
10000,385.376158,374.428585,397.536999,1.40577747,23.2995212
100000,843.774289,813.954124,868.353237,1.73690085,32.0785068
EOD
$p1_3 << EOD
x,ns,low,high,object_tests,steps
100,541.990236,539.067983,544.719199,89.4262009,0
1000,4904.59543,4843.34869,4989.88533,848.03937,0
10000,46562.8301,46267.2275,47006.5184,8189.61248,0
100000,432616.757,431448.536,437813.318,75482.7559,0
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
set logscale y; set yrange [76.727214:569157.313]; set ytics autofreq
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 3
set label 1 "brute" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 1
set label 2 "oriented" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 2
set label 3 "aligned" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "ns per ray" textcolor rgb ink; set format y "%g"
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
set logscale y; set yrange [0.670877316:98127.5826]; set ytics autofreq
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 3
set label 1 "brute" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 2
set label 2 "aligned" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 1
set label 3 "oriented" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "object tests per ray" textcolor rgb ink; set format y "%g"
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
3,231.067891,229.293208,233.66748,1.63854587,12.4090222
4,323.80277,320.938797,326.691711,1.68118286,17.4935608
5,415.089661,411.682648,417.601181,1.72131348,21.3261414
6,553.842093,547.346888,587.679164,1.67778351,25.5530301
7,739.6446,731.744633,753.044814,1.79604454,30.15625
8,949.228203,932.082938,975.210094,1.7949375,33.3222813
EOD
$p1_2 << EOD
x,ns,low,high,object_tests,steps
3,137.359099,136.318924,138.67088,2.54671749,13.9632686
4,185.783191,183.585276,188.111511,2.54559326,19.2817383
5,237.42917,234.233012,240.884651,2.78466797,23.9128418
6,327.852252,320.047188,334.587175,2.8352502,28.4122842
7,460.501615,453.437685,465.34172,3.1363189,34.5078433
8,616.771602,599.338063,628.353375,3.08628125,38.4006562
EOD
$p1_3 << EOD
x,ns,low,high,object_tests,steps
3,513.007323,509.392224,518.150906,112.75199,0
4,1844.16694,1833.11742,1851.59949,430.621951,0
5,6973.15305,6936.08231,7000.51755,1681.79268,0
6,26232.3414,26059.1127,26447.9781,6342.2777,0
7,113251.424,112152.805,114548.158,27365.9545,0
8,447210.541,443249.413,456759.796,108186.329,0
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
set logscale y; set yrange [104.860711:593787.735]; set ytics autofreq
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 3
set label 1 "brute" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 1
set label 2 "oriented" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 2
set label 3 "aligned" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "mount" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "ns per ray" textcolor rgb ink; set format y "%g"
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
set logscale y; set yrange [1.2604199:140642.228]; set ytics autofreq
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 3
set label 1 "brute" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 2
set label 2 "aligned" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 1
set label 3 "oriented" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "mount" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "object tests per ray" textcolor rgb ink; set format y "%g"
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
