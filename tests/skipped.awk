# SPDX-License-Identifier: Apache-2.0
# awk -f skipped.awk REPORT...: tests and cases of tests that ctest's JUnit reports list as skipped, and none of
# them as run: one per line, with the requirement that the test printed after "skipped: ".
function add(name) {
    if (!(name in needs)) {
        order[++count] = name
        needs[name] = said
    }
    said = ""
}
/<testcase / {
    split($0, part, "\"")
    test = part[2]
    whole = 0
    said = ""
    if (/ status="run"/) ran[test] = 1
}
/<skipped message="SKIP_/ { whole = 1 }
/skipped: / {
    said = $0
    sub(/.*skipped: /, "", said)
    sub(/<\/system-out>.*/, "", said)
}
/(^|<system-out>)\[       OK \] / { ran[$NF] = 1 }
/^\[  SKIPPED \] [a-z][a-z0-9_]*$/ { add($NF) }
/<\/testcase>/ && whole { add(test) }
END {
    for (i = 1; i <= count; i++) {
        if (order[i] in ran) continue
        gsub(/&lt;/, "<", needs[order[i]])
        gsub(/&gt;/, ">", needs[order[i]])
        gsub(/&quot;/, "\"", needs[order[i]])
        gsub(/&amp;/, "\\&", needs[order[i]])
        print "skipped " order[i] ": " needs[order[i]]
    }
}
