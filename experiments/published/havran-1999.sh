#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# havran-1999.sh DIR [OUT]: compares the counts of the experiment havran-1999 in DIR with the published figures in this folder,
# and writes OUT/published.csv (a row per figure), best.csv (a row per scene and measure) and published.md (the same to read).
# OUT is DIR unless given. Exit code 1 if a figure is outside its tolerance without a reason, no figure needs a reason, or no
# accelerator of ours needs fewer tests than the best published row of a scene. README.md defines the columns.
set -eu
here=$(dirname "$0")
LC_ALL=C exec awk -v out="${2:-$1}" '
BEGIN {
    # Percent; figures that are not whole numbers may differ by half a unit of their last digit besides.
    of_structures = "interior leaves empty_leaves references"
    tolerances = "interior 1 leaves 1 empty_leaves 1 references 3 object_tests 3 steps 3 leaf_steps - empty_steps - " \
        "primary 1 primary_hit 1 shadow 1 shadow_hit 1 secondary 1 secondary_hit 1"
    columns = split(tolerances, words, " ") / 2
    for (i = 1; i <= columns; i++) { column[i] = words[2 * i - 1]; tolerance[column[i]] = words[2 * i]; place[column[i]] = i }
    ours_count = split("bvh clusters kd item+light+bvh", ours, " ")
    measure[1] = "object_tests"; measure[2] = "object_tests+steps"
}

# The fields of a line of CSV.
function read_csv(line, fields,    count, c, i, quoted) {
    count = 1; fields[1] = ""; quoted = 0
    for (i = 1; i <= length(line); i++) {
        c = substr(line, i, 1)
        if (c == "\"" && quoted && substr(line, i + 1, 1) == "\"") { fields[count] = fields[count] c; i++ }
        else if (c == "\"") quoted = !quoted
        else if (c == "," && !quoted) fields[++count] = ""
        else fields[count] = fields[count] c
    }
    return count
}
function as_csv(text) {
    if (text !~ /[",]/) return text
    gsub(/"/, "\"\"", text)
    return "\"" text "\""
}
# Whether a pattern of file names, of * and ?, matches the text.
function fits(pattern, text) {
    gsub(/[.+]/, "[&]", pattern); gsub(/[*]/, ".*", pattern); gsub(/[?]/, ".", pattern)
    return text ~ ("^" pattern "$")
}

FNR == 1 { header = 0; file++ }
/^#/ { next }
!header { header = read_csv($0, name); for (i = 1; i <= header; i++) at[file, name[i]] = i; next }
{ read_csv($0, field) }
function get(name) { return (file, name) in at ? field[at[file, name]] : "" }

# ---- published rows: of structures, then of rays ----
file <= 2 {
    rows++
    of_rays[rows] = file == 2
    scene[rows] = get("scene"); source[rows] = get("source"); accel[rows] = get("accel"); structure[rows] = get("structure")
    parameters[rows] = get("parameters"); per_hit[rows] = get("tests_per") == "hit"
    title[rows] = of_rays[rows] ? source[rows] : structure[rows] " " parameters[rows]
    if (!(scene[rows] in seen)) { seen[scene[rows]] = 1; scenes[++scene_count] = scene[rows] }
    for (i = 1; i <= header; i++) {
        if (!(name[i] in place) || field[i] == "") continue
        row[++figures] = rows; column_of[figures] = name[i]; published[figures] = field[i]
        figure[rows, name[i]] = figures
    }
}

# ---- reasons ----
file == 3 {
    reasons++
    reason[reasons] = get("reason"); line_of[reasons] = FNR
    where_scene[reasons] = get("scene"); where_source[reasons] = get("source")
    where_accel[reasons] = get("accel"); where_column[reasons] = get("column")
}

# ---- counts: sums over the kinds of rays ----
file == 4 {
    key = get("scene") SUBSEP get("accel")
    kind = get("kind") == "reflection" || get("kind") == "transmission" ? "secondary" : get("kind")
    if (get("width") < 512) quick = 1 # other rays than the published ones: only structures can be judged
    if (get("accel") == ours[1]) { # every accelerator has the same rays
        count[get("scene"), kind] += get("rays")
        count[get("scene"), kind "_hit"] += get("hits")
    }
    rays[key] += get("rays"); hits[key] += get("hits"); extent_tests[key] += get("extent_tests")
    object_tests[key] += get("object_tests"); steps[key] += get("steps")
    leaf_steps[key] += get("leaf_steps"); empty_steps[key] += get("empty_steps")
    interior[key] = get("interior"); leaves[key] = get("leaves")
    empty_leaves[key] = get("empty_leaves"); references[key] = get("references")
}

# The measured figure, or "".
function measure_of(r, column,    key) {
    key = scene[r] SUBSEP accel[r]
    if (of_rays[r]) return (scene[r], "primary") in count ? count[scene[r], column] + 0 : ""
    if (!(key in rays)) return ""
    if (column == "interior") return interior[key]
    if (column == "leaves") return leaves[key]
    if (column == "empty_leaves") return empty_leaves[key]
    if (column == "references") return references[key]
    if (column == "object_tests") return object_tests[key] / (per_hit[r] ? hits[key] : rays[key])
    if (column == "steps") return steps[key] / rays[key]
    return (column == "leaf_steps" ? leaf_steps[key] : empty_steps[key]) / rays[key]
}
function show(value) { return sprintf(value == int(value) ? "%.0f" : "%.6g", value) }
function find_reason(f,    i, r) {
    r = row[f]
    for (i = 1; i <= reasons; i++)
        if (fits(where_scene[i], scene[r]) && fits(where_source[i], source[r]) && fits(where_accel[i], accel[r]) &&
            fits(where_column[i], column_of[f])) return i
    return 0
}
# Fills in measured, deviation, judged ("within", "outside" or "unjudged") and reason_of.
function judge(f,    name, per_ray, digits, most, difference) {
    name = column_of[f]; measured[f] = measure_of(row[f], name); judged[f] = "unjudged"
    if (measured[f] == "") return
    difference = measured[f] - published[f]
    deviation[f] = difference == 0 ? 0 : 100 * difference / published[f]
    if (tolerance[name] == "-" || (quick && !index(of_structures, name))) return
    digits = index(published[f], ".") ? length(published[f]) - index(published[f], ".") : 0
    per_ray = name == "object_tests" || name == "steps"
    most = 0.01 * tolerance[name] * published[f] + (per_ray ? 0.5 / 10 ^ digits : 0)
    judged[f] = difference <= most && -difference <= most ? "within" : "outside"
    if (judged[f] == "within") return
    reason_of[f] = find_reason(f)
    used[reason_of[f]]++
    if (!reason_of[f]) fail(name " of " title[row[f]] " on " scene[row[f]] " is " show(measured[f]) ", published is " published[f] \
        ": outside the tolerance, without a reason")
}
function fail(message) { print "havran-1999: " message | "cat >&2"; failed = 1 }

# Of a scene, the published row and the accelerator of ours that need least of measure m.
function find_best(s, m,    r, key, value, i) {
    best_row = 0; best_ours = ""
    key = s SUBSEP ours[1]
    for (r = 1; r <= rows; r++) {
        if (scene[r] != s || of_rays[r] || !((r, "object_tests") in figure)) continue
        value = published[figure[r, "object_tests"]] * (per_hit[r] ? hits[key] / rays[key] : 1)
        if (m == 2) value += published[figure[r, "steps"]]
        if (!best_row || value < best_published) { best_published = value; best_row = r }
    }
    for (i = 1; i <= ours_count; i++) {
        key = s SUBSEP ours[i]
        if (!(key in rays)) continue
        value = (object_tests[key] + (m == 2 ? steps[key] : 0)) / rays[key]
        if (best_ours == "" || value < best_value) {
            best_value = value; best_ours = ours[i]; best_extents = extent_tests[key] / rays[key]
        }
    }
    return best_row && best_ours != ""
}

function write_csv(    f, r, per) {
    file = out "/published.csv"
    print "scene,source,structure,parameters,accel,column,per,published,measured,deviation,tolerance,within,reason" >file
    for (f = 1; f <= figures; f++) {
        r = row[f]; per = column_of[f] == "object_tests" ? (per_hit[r] ? "hit" : "ray") : ""
        print as_csv(scene[r]) "," as_csv(source[r]) "," as_csv(structure[r]) "," as_csv(parameters[r]) "," accel[r] "," \
            column_of[f] "," per "," published[f] "," (measured[f] == "" ? "," : show(measured[f]) "," sprintf("%.2f", deviation[f])) \
            "," (tolerance[column_of[f]] == "-" ? "" : tolerance[column_of[f]]) "," \
            (judged[f] == "unjudged" ? "" : judged[f] == "within" ? "yes" : "no") "," as_csv(reason[reason_of[f]]) >file
    }
    file = out "/best.csv"
    print "scene,measure,published_row,published,accel,ours,extent_tests,ahead" >file
    for (s = 1; s <= scene_count; s++) for (m = 1; m <= 2; m++) {
        if (!find_best(scenes[s], m)) continue
        printf "%s,%s,%s,%.6g,%s,%.6g,%.6g,%s\n", scenes[s], measure[m], as_csv(title[best_row]), best_published, best_ours, \
            best_value, best_extents, best_value < best_published ? "yes" : "no" >file
    }
}

# ---- published.md ----
function write_rows(s, rays_only,    i, r, f, shown, line, bold) {
    line = "| row |"; shown = "| --- |"
    delete used_column
    for (f = 1; f <= figures; f++) if (scene[row[f]] == s && of_rays[row[f]] == rays_only) used_column[column_of[f]] = 1
    for (i = 1; i <= columns; i++) if (column[i] in used_column) { line = line " " column[i] " |"; shown = shown " --- |" }
    if (line == "| row |") return
    print "\n" line "\n" shown >file
    for (r = 1; r <= rows; r++) {
        if (scene[r] != s || of_rays[r] != rays_only) continue
        line = "| " title[r] " |"
        for (i = 1; i <= columns; i++) {
            if (!(column[i] in used_column)) continue
            if (!((r, column[i]) in figure)) { line = line " |"; continue }
            f = figure[r, column[i]]; bold = judged[f] == "outside" ? "**" : ""
            line = line " " published[f]
            if (measured[f] != "") line = line sprintf("; %s%s (%+.1f %%)%s", bold, show(measured[f]), deviation[f], bold)
            line = line (column[i] == "object_tests" && per_hit[r] ? " per hit |" : " |")
        }
        print line >file
    }
}
function write_markdown(    i, f, s, m, sums) {
    file = out "/published.md"
    print "# havran-1999: published, measured\n\nWritten by `experiments/published/havran-1999.sh`. A cell shows the published " \
        "figure, then the measured one and its deviation, in bold if it exceeds the tolerance.\n\n" \
        "| column | figures | within | outside | not judged |\n| --- | --- | --- | --- | --- |" >file
    for (f = 1; f <= figures; f++) { sums[column_of[f]]++; sums[column_of[f], judged[f]]++ }
    for (i = 1; i <= columns; i++)
        printf "| %s%s | %d | %d | %d | %d |\n", column[i], tolerance[column[i]] == "-" ? "" : ", " tolerance[column[i]] " %", \
            sums[column[i]], sums[column[i], "within"], sums[column[i], "outside"], sums[column[i], "unjudged"] >file
    print "\n## Ours compared with the best published row\n\nPer ray, over all kinds. Rows that count tests per hit are converted " \
        "to tests per ray. Published rows count no extent tests, of which a grid or an octree makes one per ray; ours make those " \
        "listed. The last column compares without extent tests, then with them.\n\n" \
        "| scene | measure | best published row | published | ours | measured | extent tests | ours needs |\n" \
        "| --- | --- | --- | --- | --- | --- | --- | --- |" >file
    for (s = 1; s <= scene_count; s++) for (m = 1; m <= 2; m++) {
        if (!find_best(scenes[s], m)) continue
        ahead = best_value < best_published; in_all = best_value + best_extents < best_published + 1
        if (!ahead && !quick) fail("on " scenes[s] " none of ours needs fewer " measure[m] " per ray than the best published row")
        printf "| %s | %s | %s | %.4g | `%s` | %.4g | %.4g | %s |\n", scenes[s], measure[m], title[best_row], best_published, \
            best_ours, best_value, best_extents, !ahead ? "not fewer" : in_all ? "fewer, also with extent tests" : \
            "fewer, but **more with extent tests**" >file
    }
    for (s = 1; s <= scene_count; s++) {
        print "\n## " scenes[s] >file
        write_rows(scenes[s], 1)
        write_rows(scenes[s], 0)
    }
    print "\n## Reasons for deviations\n" >file
    for (i = 1; i <= reasons; i++) {
        if (!used[i] && !quick) fail("line " line_of[i] " of the reasons: no figure needs this reason")
        if (used[i]) printf "- `%s` of `%s` on `%s` (%s): %s [%d]\n", where_column[i], where_accel[i] == "" ? "the rays" : \
            where_accel[i], where_scene[i], where_source[i], reason[i], used[i] >file
    }
}

END {
    for (f = 1; f <= figures; f++) judge(f)
    write_csv()
    write_markdown()
    exit failed
}' "$here/havran-1999.csv" "$here/ray-invariants.csv" "$here/havran-1999-reasons.csv" "$1/counts.csv"
