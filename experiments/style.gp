# SPDX-License-Identifier: Apache-2.0
# The common style of all plots, and functions to read the CSV files. raytally runs this before other scripts, with variables
# (gnuplot -e), in the order of the experiment and without what has no rows:
#   scenes, files       labels of scenes, and these as parts of file names
#   accels, groups      labels of accelerators, and their groups
#   colors, markers, dashes   of each accelerator
#   kinds, sets         kinds of rays; SCENE/KIND=WEIGHT of each set of rays
#   baseline            label of the accelerator that ratios refer to
#   without, among      of `frame` in the experiment
#   sweeps, axes        swept parameters, and "log", "linear" or "words" for each (sweeps.gp)
#   experiment, format, paper, shared   its name; svg or pdf; column or page; the folder of this file
# Lists are of words. Totals weight a ray kind by the number of rays in its whole set (weight(0), the row at hand's), so
# accelerators that were measured on every Kth ray compare with the others, and a lower limit changes nothing.
#
# A comment "#: NAME: text" in a script, continued in lines "#:   text", is the caption of plot NAME in the report; its first
# sentence is the alternative text of the plot. * in NAME stands for any text.

whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))

# A CSV file as one of tabs, for `set datafile separator tab`: gnuplot 5.4 ends a quoted field at its first comma.
tsv(file) = "< awk -F '\"' '{ for (i = 1; i <= NF; i += 2) gsub(\",\", \"\t\", $i); print }' OFS= ".file

set datafile separator comma
set datafile columnheaders
set datafile missing NaN

# The style of accelerator a, the same in every plot and in the report. Marker and dash distinguish lines in grey print.
color(a) = word(colors, a)
marker(a) = int(word(markers, a))
dash(a) = int(word(dashes, a))
ink = "#222222"; faint = "#d9d9d9"; soft = "#666666"

# The style of other things: scenes, ray kinds.
hue(i) = word("#0072b2 #d55e00 #009e73 #7b3294 #e69f00 #222222 #56b4e9 #a6761d", 1 + (i - 1) % 8)
mark(i) = int(word("7 5 9 13 11 6 4 8 12 10", 1 + (i - 1) % 10))
stroke(i) = 1 + (i - 1) % 5

# A figure with three digits: 0.034, 1.24, 12.4, 124, 69666.
figure(x) = x != x ? "–" : x == 0 ? "0" : x < 0.01 ? "< 0.01" : x < 0.1 ? sprintf("%.3f", x) : x < 1 ? sprintf("%.2f", x) : \
            x < 10 ? sprintf("%.1f", x) : sprintf("%.0f", x)

# Opens plots/NAME.svg, or .pdf as wide as a column of a paper (3.5 in up to 480 pixels, else both columns, 7.16 in). In a pdf a
# pixel is `point` points, and three quarters of that for letters. Letters of `font` 13 and more have at least 8 points there.
# raytally draws both, and removes .tmp when all is drawn.
letters = 1.2
point(width) = 72.0 * (width <= 480 ? 3.5 : 7.16) / width
canvas(name, width, height) = format eq "pdf" ? \
  sprintf("set terminal pdfcairo size %.3fin,%.3fin font 'Helvetica,13' fontscale %.4f linewidth %.4f pointscale %.4f background '#ffffff'; \
set output 'plots/%s.pdf.tmp'", point(width) * width / 72, point(width) * height / 72, 0.75 * letters * point(width), point(width), \
    1.9 * point(width), name) : \
  sprintf("set terminal svg size %d,%d dynamic font 'Helvetica,13' fontscale %.4f background '#ffffff'; \
set output 'plots/%s.svg.tmp'", width, height, letters, name)

# For plots of several panels: their width in pixels, and the panels beside each other, at most `most` where the page is wide.
wide = paper eq "column" ? 480 : 960
across(most, panels) = paper eq "column" ? (panels > 3 ? 2 : 1) : panels < most ? panels : most

# Tics of ratios from low to high on a logarithmic axis: eval "set ytics ".ratio_tics(low, high)
ratio_tics(low, high) = high < 2.5 * low ? \
  '("0.5" 0.5, "0.6" 0.6, "0.7" 0.7, "0.8" 0.8, "0.9" 0.9, "1" 1, "1.2" 1.2, "1.4" 1.4, "1.7" 1.7, "2" 2, "2.5" 2.5)' : high < 6 * low ? \
  '("0.2" 0.2, "0.3" 0.3, "0.5" 0.5, "0.7" 0.7, "1" 1, "1.4" 1.4, "2" 2, "3" 3, "4" 4)' : paper eq "column" && high > 12 * low ? \
  '("1/64" 1.0 / 64, "1/16" 1.0 / 16, "1/4" 0.25, "1" 1, "4" 4, "16" 16, "64" 64)' : \
  '("1/32" 1.0 / 32, "1/16" 1.0 / 16, "1/8" 0.125, "1/4" 0.25, "1/2" 0.5, "1" 1, "2" 2, "4" 4, "8" 8, "16" 16, "32" 32)'

# Requires `last`. Fills `order`, the indices of its numbers from the greatest to the least, as lines end at the right.
sort_last = "order = ''; do for [n_ = 1:|last|] { best_ = 0; do for [i_ = 1:|last|] { \
if (strstrt(' '.order, sprintf(' %d ', i_)) == 0) { if (best_ == 0) { best_ = i_ } else { if (last[i_] > last[best_]) { best_ = i_ } } } }; \
order = order.sprintf('%d ', best_) }"

# Panels: a thin frame below and to the left, grid lines behind.
set border 3 linecolor rgb soft
set tics nomirror scale 0.5 textcolor rgb ink
set grid xtics linecolor rgb faint linetype 1 linewidth 0.5
set style fill solid 0.9 noborder
set bars small
unset key
