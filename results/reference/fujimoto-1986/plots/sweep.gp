# Written by raytally: cost over each swept parameter, over all ray kinds. For your own plots name
# gnuplot scripts under `plots` of the experiment.

reset session
load "plots/names.gp"; load "plots/style.gp"
set grid xtics ytics
$p1_1 << EOD
x,ns,low,high,object_tests,steps
1000,134.390252,132.49842,136.071892,6.30129825,2.87327665
10000,217.811426,202.125082,237.69157,7.9021745,3.70451711
100000,510.313704,362.636295,598.622752,8.50412632,3.82174296
1000000,1189.53439,1143.34717,1266.31491,9.20034247,4.26412671
EOD
$p1_2 << EOD
x,ns,low,high,object_tests,steps
1000,231.30165,226.977715,238.504948,8.06686581,13.5109145
10000,496.852387,464.246977,532.225056,9.85803373,22.6779459
100000,1017.37799,862.632354,1142.85213,10.1448063,29.1316021
1000000,2046.54187,1991.93787,2157.04939,10.9720141,37.8087008
EOD
$p1_3 << EOD
x,ns,low,high,object_tests,steps
1000,193.665615,191.360702,200.471973,1.10070083,14.532801
10000,379.916464,358.316552,421.562216,1.32866981,22.3376715
100000,810.360517,692.458654,897.861631,1.61559199,30.0258583
1000000,1640.98839,1564.4177,1724.41278,1.97206764,39.1362907
EOD
set style line 1 linecolor rgb "#009e73" dashtype 1 pointtype 7 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 2 linecolor rgb "#56b4e9" dashtype 1 pointtype 5 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 3 linecolor rgb "#cc79a7" dashtype 1 pointtype 9 pointsize 0.55 linewidth 1.6 pointinterval 1
set logscale x
set xrange [952.380952:1050000]
set format x "10^{%T}"

#: 01-sweep-n-time: Time per ray over n, a line per accelerator, a panel per scene.
#:   All kinds of rays together, medians with intervals. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("01-sweep-n-time", 480, 338)
set multiplot
set logscale y; set yrange [101.921862:2804.16421]; set ytics autofreq
set ytics (200,500,1000,2000)
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 2
set label 1 "glassner" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 3
set label 2 "hierarchy" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 1
set label 3 "3ddda" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "ns per ray" textcolor rgb ink; set format y "%g"
set xlabel "n" noenhanced textcolor rgb ink
order = "2 3 1 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:2 with linespoints linestyle int(word(order, i)) notitle, for [i = 1:words(order)] '$p1_'.word(order, i) using 1:3:(0):($4 - $3) with vectors heads size graph 0.01, 90 nofilled linestyle int(word(order, i)) dashtype 1 linewidth 1.6 notitle
unset arrow; unset label
unset multiplot
unset output

#: 02-sweep-n-object-tests: Object tests per ray over n, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("02-sweep-n-object-tests", 480, 338)
set multiplot
unset logscale y; set ytics autofreq; set yrange [0:11.630335]
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 2
set label 1 "glassner" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 1
set label 2 "3ddda" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 3
set label 3 "hierarchy" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "object tests per ray" textcolor rgb ink; set format y "%g"
set xlabel "n" noenhanced textcolor rgb ink
order = "2 1 3 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:5 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output

#: 03-sweep-n-steps: Steps per ray over n, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("03-sweep-n-steps", 480, 338)
set multiplot
set logscale y; set yrange [2.21021281:50.8771779]; set ytics autofreq
set ytics (5,10,20,50)
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 3
set label 1 "hierarchy" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 2
set label 2 "glassner" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 1
set label 3 "3ddda" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "scattered" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "steps per ray" textcolor rgb ink; set format y "%g"
set xlabel "n" noenhanced textcolor rgb ink
order = "3 2 1 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:6 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output

reset session
load "plots/names.gp"; load "plots/style.gp"
set grid xtics ytics
$p1_1 << EOD
x,ns,low,high,object_tests,steps
3,189.260519,184.129569,196.131344,13.9061961,5.60431034
6,276.127259,274.081765,278.846509,20.3182112,9.47532328
12,396.941442,394.535201,401.535542,26.0778017,15.3935345
24,583.690499,574.423662,588.340454,35.3230065,23.3469828
48,922.493144,900.789925,962.662958,50.3307651,37.5860991
EOD
$p1_2 << EOD
x,ns,low,high,object_tests,steps
3,387.571157,377.241572,402.649587,11.4553879,32.2298491
6,453.930487,449.440392,461.149425,11.8949353,37.5984914
12,653.188856,640.943983,673.595851,12.4697737,52.3153017
24,1005.57107,984.97896,1023.34784,13.2929418,68.6933728
48,1240.50718,1210.14294,1292.67928,15.0728448,78.8247306
EOD
$p1_3 << EOD
x,ns,low,high,object_tests,steps
3,257.144516,205.001485,279.769546,2.25915948,21.5561422
6,269.998924,267.404978,274.656482,2.32742457,25.4223599
12,363.880363,359.369203,372.239435,2.34967672,30.8963901
24,516.731169,507.078825,523.904777,2.45894397,37.0448276
48,727.391231,709.617349,753.601176,2.42047414,42.5492996
EOD
set style line 1 linecolor rgb "#009e73" dashtype 1 pointtype 7 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 2 linecolor rgb "#56b4e9" dashtype 1 pointtype 5 pointsize 0.55 linewidth 1.6 pointinterval 1
set style line 3 linecolor rgb "#cc79a7" dashtype 1 pointtype 9 pointsize 0.55 linewidth 1.6 pointinterval 1
set logscale x
set xrange [2.85714286:50.4]
set xtics ("3" 3,"6" 6,"12" 12,"24" 24,"48" 48)

#: 04-sweep-size-time: Time per ray over size, a line per accelerator, a panel per scene.
#:   All kinds of rays together, medians with intervals. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("04-sweep-size-time", 480, 338)
set multiplot
unset logscale y; set ytics autofreq; set yrange [0:1370.24004]
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 2
set label 1 "glassner" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 1
set label 2 "3ddda" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 3
set label 3 "hierarchy" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "teapot" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "ns per ray" textcolor rgb ink; set format y "%g"
set xlabel "size" noenhanced textcolor rgb ink
order = "2 1 3 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:2 with linespoints linestyle int(word(order, i)) notitle, for [i = 1:words(order)] '$p1_'.word(order, i) using 1:3:(0):($4 - $3) with vectors heads size graph 0.01, 90 nofilled linestyle int(word(order, i)) dashtype 1 linewidth 1.6 notitle
unset arrow; unset label
unset multiplot
unset output

#: 05-sweep-size-object-tests: Object tests per ray over size, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("05-sweep-size-object-tests", 480, 338)
set multiplot
set logscale y; set yrange [1.73781499:65.4299946]; set ytics autofreq
set ytics (2,5,10,20,50)
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 1
set label 1 "3ddda" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 2
set label 2 "glassner" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 3
set label 3 "hierarchy" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "teapot" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "object tests per ray" textcolor rgb ink; set format y "%g"
set xlabel "size" noenhanced textcolor rgb ink
order = "1 2 3 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:5 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output

#: 06-sweep-size-steps: Steps per ray over size, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the lines at the right of the first panel.
eval canvas("06-sweep-size-steps", 480, 338)
set multiplot
set logscale y; set yrange [4.31100796:102.47215]; set ytics autofreq
set ytics (5,10,20,50,100)
set arrow 1 from screen 0.0250, screen 0.0414 to screen 0.0917, screen 0.0414 nohead linestyle 2
set label 1 "glassner" at screen 0.0583, screen 0.0414 left noenhanced point linestyle 2 offset screen 0.0458, 0 textcolor rgb ink
set arrow 2 from screen 0.3417, screen 0.0414 to screen 0.4083, screen 0.0414 nohead linestyle 3
set label 2 "hierarchy" at screen 0.3750, screen 0.0414 left noenhanced point linestyle 3 offset screen 0.0458, 0 textcolor rgb ink
set arrow 3 from screen 0.6583, screen 0.0414 to screen 0.7250, screen 0.0414 nohead linestyle 1
set label 3 "3ddda" at screen 0.6917, screen 0.0414 left noenhanced point linestyle 1 offset screen 0.0458, 0 textcolor rgb ink
set lmargin at screen 0.1750; set rmargin at screen 0.9500; set tmargin at screen 0.9053; set bmargin at screen 0.2544
set title "teapot" noenhanced textcolor rgb ink offset 0, -0.4
set ylabel "steps per ray" textcolor rgb ink; set format y "%g"
set xlabel "size" noenhanced textcolor rgb ink
order = "2 3 1 "
plot for [i = 1:words(order)] '$p1_'.word(order, i) using 1:6 with linespoints linestyle int(word(order, i)) notitle
unset arrow; unset label
unset multiplot
unset output
