# SPDX-License-Identifier: Apache-2.0
# sweeps: cost over each swept parameter, for experiments that name no scripts. raytally writes plots/sweep-KEY.tsv
# (src/report/plot.c has the columns).
#: *-sweep-*-time: Time per ray over the swept parameter, a line per accelerator, a panel per scene.
#:   All kinds of rays together, medians with intervals. All panels have the same scales; the legend has the order of the sweep.
#: *-sweep-*-object-tests: Object tests per ray over the swept parameter, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the sweep.
#: *-sweep-*-steps: Steps per ray over the swept parameter, a line per accelerator, a panel per scene.
#:   All kinds of rays together. All panels have the same scales; the legend has the order of the sweep.

array measure[3] = ["time", "object-tests", "steps"]
array unit[3] = ["ns per ray", "object tests per ray", "steps per ray"]
array value_column[3] = [7, 10, 11]
# Notes the words of a column, each once.
note_line(name) = strstrt(" ".lines, " ".name." ") ? 1 : (lines = lines.name." ", styles = styles.sprintf("%d %d ", $3, $4), 1)
note_value(name) = strstrt(" ".values, " ".name." ") ? 1 : (values = values.name." ", places = places.sprintf("%.9g ", $5), 1)
note_flat(name) = $4 > 0 || strstrt(" ".flats, " ".name." ") ? 1 : (flats = flats.name." ", 1)
note_panel(name) = strstrt(" ".panels, " ".name." ") ? 1 : (panels = panels.name." ", 1)
color_of(i) = int(word(styles, 2 * i - 1)); marker_of(i) = int(word(styles, 2 * i))
dash_of(i) = marker_of(i) ? 1 : 2

number = 0
do for [k = 1:words(sweeps)] {
  key = word(sweeps, k); axis = word(axes, k)
  data = "plots/sweep-".key.".tsv"
  lines = ""; styles = ""; values = ""; places = ""; panels = ""; flats = ""
  do for [m = 1:3] {
    reset
    load shared."/style.gp"
    set datafile separator tab
    set datafile nocolumnheaders
    set grid xtics ytics
    if (m == 1) { stats data using (note_panel(strcol(1)) + note_flat(strcol(1)) + note_line(strcol(2)) + note_value(strcol(6))) nooutput }
    n_lines = words(lines); n_panels = words(panels); n_values = words(values)
    v = value_column[m]
    stats data using (valid(v) && column(v) > 0 ? 1 : 0) nooutput # of nothing but blanks, gnuplot 6 has no sum
    if (STATS_sum > 0) {
      number = number + 1
      stats data using (column(v) > 0 ? column(v) : NaN) nooutput
      least = STATS_min; most = STATS_max
      if (m == 1) {
        stats data using (column(8) > 0 ? column(8) : NaN) nooutput
        least = STATS_min < least ? STATS_min : least
        stats data using (column(9) > 0 ? column(9) : NaN) nooutput
        most = STATS_max > most ? STATS_max : most
      }
      stats data using 5 nooutput
      first = STATS_min; last = STATS_max; span = last - first
      decades = axis eq "log" && last >= 1000 * first

      # Panels beside each other, the legend below them.
      columns = paper eq "column" ? 2 : 3
      columns = n_panels < columns ? n_panels : columns
      rows = (n_panels + columns - 1) / columns
      width = columns == 1 ? 480.0 : real(wide)
      longest = 0
      do for [name in lines] { if (strlen(name) > longest) { longest = strlen(name) } }
      key_columns = int((width - 20) / (56 + 8.8 * longest))
      key_columns = key_columns < 1 ? 1 : key_columns > n_lines ? n_lines : key_columns
      key_rows = (n_lines + key_columns - 1) / key_columns
      gap = axis eq "words" ? 84 : 66
      foot = 20 * key_rows + gap
      height = 32.0 + rows * (220 + gap) - gap + foot
      eval canvas(sprintf("%02d-sweep-%s-%s", number, key, measure[m]), width, height)
      set multiplot layout rows, columns margins screen 84 / width, 1 - 24 / width, foot / height, 1 - 32 / height \
        spacing screen 24 / width, gap / height

      if (axis eq "log") {
        set logscale x
        set xrange [first / 1.05 : last * 1.05]
      } else { set xrange [first - (axis eq "words" ? 0.2 : 0.02 * span) : last + (axis eq "words" ? 0.2 : 0.02 * span)] }
      if (most > 10 * least) {
        set logscale y
        set yrange [least / 1.3 : most * 1.3]
      } else { set yrange [0 : 1.06 * most] }
      y_format = most > 10 * least && most >= 1e5 ? "10^{%T}" : "%g"
      if (axis eq "words") { set xtics rotate by -30 }
      if (decades) { set format x "10^{%T}" }
      if (axis eq "linear" && n_values > 8 && first == int(first) && span < 16) { set xtics ceil(span / 8) }
      if ((axis eq "words" || n_values <= 8) && !decades) {
        set xtics ()
        do for [i = 1:n_values] { set xtics add (word(values, i) real(word(places, i))) }
      }
      do for [p = 1:n_panels] {
        set title word(panels, p) noenhanced textcolor rgb ink offset 0, -0.4
        if (p % columns == 1 % columns) { set ylabel unit[m] textcolor rgb ink; set format y y_format } else { unset ylabel; set format y "" }
        if (most > 10 * least && most < 50 * least) { # a single power of ten may be within the range
          set ytics ()
          do for [e = floor(log10(least)) - 1:ceil(log10(most))] {
            do for [step in "1 2 5"] {
              set ytics add (p % columns == 1 % columns ? sprintf("%g", real(step) * 10.0 ** e) : "" real(step) * 10.0 ** e)
            }
          }
        }
        flat = strstrt(" ".flats, " ".word(panels, p)." ") > 0
        if (p > n_panels - columns) { set xlabel key noenhanced textcolor rgb ink } else { unset xlabel }
        if (p == 1) {
          set key at screen 0.5, screen 6 / height center bottom vertical maxrows key_rows samplen 2 noenhanced textcolor rgb ink Left reverse
        } else { unset key }
        plot data index p - 1 using 5:($4 > 0 ? column(v) : NaN):3 with lines linewidth 1.6 linecolor rgb variable notitle, \
          for [i = 1:flat] "" index p - 1 using 5:($4 == 0 ? column(v) : NaN):3 with lines dashtype 2 linewidth 1.6 linecolor rgb variable notitle, \
          "" index p - 1 using 5:($4 > 0 ? column(v) : NaN):4:3 with points pointtype variable pointsize 0.6 linecolor rgb variable notitle, \
          for [i = 1:(m == 1)] "" index p - 1 using 5:($4 > 0 ? $8 : NaN):(0):($9 - $8):3 with vectors heads size graph 0.01, 90 nofilled linewidth 1.2 linecolor rgb variable notitle, \
          for [i = 1:n_lines] keyentry with linespoints pointtype marker_of(i) dashtype dash_of(i) linewidth 1.6 linecolor rgb color_of(i) title word(lines, i)
      }
      unset multiplot
      unset output
    }
  }
}
