# SPDX-License-Identifier: Apache-2.0
# What the plots of all experiments share: the look, and reading the CSV files. names.gp runs before this.
#
# A ray kind weighs in totals what its whole set has of rays (set_rays), so that accelerators that were measured on
# every Kth ray compare with the others.

set datafile separator comma
set datafile columnheaders
set datafile missing NaN

color(accel_number) = word(colors, accel_number)
ink = "#222222"; faint = "#d9d9d9"; soft = "#666666"

# A figure in three digits: 0.034, 1.24, 12.4, 124, 69666.
figure(x) = x != x ? "–" : x == 0 ? "0" : x < 0.01 ? "< 0.01" : x < 0.1 ? sprintf("%.3f", x) : x < 1 ? sprintf("%.2f", x) : \
            x < 10 ? sprintf("%.1f", x) : sprintf("%.0f", x)

# Opens plots/NAME.svg; raytally takes the .tmp away when all is drawn.
svg(name, width, height) = sprintf("set terminal svg size %d,%d dynamic font 'Helvetica,13' background '#ffffff'; \
set output 'plots/%s.svg.tmp'", width, height, name)

# Panels: a thin frame below and to the left, grid lines behind.
set border 3 linecolor rgb soft
set tics nomirror scale 0.5 textcolor rgb ink
set grid xtics linecolor rgb faint linetype 1 linewidth 0.5
set style fill solid 0.9 noborder
unset key
