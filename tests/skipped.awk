# SPDX-License-Identifier: Apache-2.0
# awk -f skipped.awk REPORT...: the tests and the cases of tests that ctest's JUnit reports say were skipped, and that none of
# them says were run: one a line, with what the test has printed after "skipped: ", which is what it needs.
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
