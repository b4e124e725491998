# SPDX-License-Identifier: Apache-2.0
# Plots of the pages in docs/accelerators: counts over the one parameter that an experiment sweeps, one line per
# scene; bars if its values are words. All ray kinds together. Writes plots/NAME.svg, where NAME is the experiment's.
#
# The plotted counts depend on the accelerator, whose name begins NAME.

counters = experiment[1:6] eq "light-" || experiment[1:5] eq "item-" ? "object_tests steps passed_on" : \
           experiment[1:8] eq "extents-" ? "object_tests" : \
           experiment[1:9] eq "clusters-" || experiment[1:4] eq "bvh-" ? "object_tests extent_tests steps" : "object_tests steps"
param = system("head -n 1 counts.csv | sed 's/.*,//'")   # the swept parameter is the last column

# One row per value, one column per scene: events per ray. Only `spec` has commas within quotes, so columns
# behind it are counted from the end.
table(counter) = "< awk -F, -v counter=".counter." -v scenes='".scenes."' '\
NR == 1 { for (i = 1; i <= NF; i++) { if ($i == counter) what = NF - i; if ($i == \"rays\") rays = NF - i } \
n = split(scenes, name, \" \"); printf \"value\"; for (s = 1; s <= n; s++) printf \",%s\", name[s]; print \"\"; next } \
!($NF in seen) { seen[$NF] = 1; value[++m] = $NF } \
{ sum[$1, $NF] += $(NF - what); of[$1, $NF] += $(NF - rays) } \
END { for (v = 1; v <= m; v++) { printf \"%s\", value[v]; \
for (s = 1; s <= n; s++) printf \",%.9g\", sum[name[s], value[v]] / of[name[s], value[v]]; print \"\" } }' counts.csv"

title_of(counter) = counter eq "passed_on" ? "passed on, a part of the rays" : \
                    counter eq "object_tests" ? "object tests per ray" : \
                    counter eq "extent_tests" ? "extent tests per ray" : counter." per ray"

words_are_values = system("tail -n 1 counts.csv | sed 's/.*,//' | grep -c '^[a-z]'") eq "1"

panels = words(counters)
eval canvas(experiment, 40 + 340 * panels, 330)
set multiplot layout 1, panels margins screen 0.14 / panels, 1 - 0.04 / panels, 0.19, words(scenes) > 3 || panels == 1 ? 0.75 : 0.8 spacing screen 0.19 / panels
set key at screen 0.5, 0.985 center top horizontal samplen 1.5 font ',11' textcolor rgb ink noenhanced
set xlabel param[7:] noenhanced textcolor rgb ink offset 0, 0.4
set grid ytics
if (words_are_values) {
    set style data histograms; set style histogram clustered gap 1
    set xtics rotate by (words(system("sed 1d counts.csv | sed 's/.*,//' | sort -u")) > 3 ? 22 : 0) right noenhanced
} else {
    least = real(system("sed 1d counts.csv | sed 's/.*,//' | sort -g | head -n 1"))
    most = real(system("sed 1d counts.csv | sed 's/.*,//' | sort -g | tail -n 1"))
    if (most > 20 * least) { set logscale x 2 }
    set format x "%g"
    set xrange [least:most]
    if (most - least < 5) { set xtics 1 }
}
do for [counter in counters] {
    set title title_of(counter) textcolor rgb ink
    if (words_are_values) {
        set yrange [0:*]
        plot for [i = 1:words(scenes)] table(counter) using i + 1:xtic(1) linecolor rgb hue(i) title word(scenes, i)
    } else {
        if (counter eq "passed_on") { unset logscale y; set yrange [0:*] } else { set logscale y }
        plot for [i = 1:words(scenes)] table(counter) using 1:i + 1 with linespoints linewidth 1.8 pointtype mark(i) pointsize 0.5 \
             linecolor rgb hue(i) title word(scenes, i)
    }
    unset key
}
unset multiplot
unset output
