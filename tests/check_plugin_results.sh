#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_plugin_results.sh: results of plugins stay usable. Without the plugin they are plotted, reported and compared as with
# it. A run resumes with other plugins loaded; if its own plugin has changed (here by a byte after the library), both builds are
# named, and --resume measures only its cells again. Uses $RT_PROGRAM, in its build folder, and python3.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/testing.sh"
plugins=$(dirname "$program")/plugins
command -v python3 >/dev/null || { echo 'skipped: results of plugins; needs python3' && exit 77; }
cd "$work" || exit 2
unset RAYTALLY_PLUGINS

# The default baseline is the first accelerator that is not a plugin's; the results must name it.
cat >mine.yaml <<'END_OF_YAML'
name: mine
question: Do boxes help?
prediction: They do.
scenes:
  - {scene: "balls:size=1|2", size: 16x16, depth: 2}
accelerators:
  - {accel: "my-accel:boxes=on|off"}
  - {accel: bvh}
  - {accel: kd}
rays: [primary, shadow]
rounds: 2
milliseconds: 1
expect:
  - ratio of object_tests of my-accel:boxes=on to my-accel:boxes=off < 1.01
END_OF_YAML
sed -e 's/^name: mine/name: based/' -e 's/^rays:/baseline: "my-accel:boxes=on"\nrays:/' mine.yaml >based.yaml
mkdir old new && cp "$plugins/new-accel.so" old/mine.so
{ cat old/mine.so && echo; } >new/mine.so
hash='[0-9a-f]{16}'
ends 0 run mine.yaml --plugin old/mine.so

# ---- without the plugin ----

cp results/mine/report.html with.html
ends 0 plot results/mine
ends 0 report results/mine
cmp -s with.html results/mine/report.html || complain "without the plugin the report is another: $(diff with.html results/mine/report.html | cut -c 1-300)"
grep -qF "$work/old/mine.so" with.html && grep -qE "\"hash\": *\"$hash\"" with.html || complain 'the report does not name the plugin'
ends 0 report --index results
says_not 'cannot be read'
! grep -q 'cannot be read' results/index.html || complain 'the index cannot read the results of a plugin'
cp -r results/mine results/again
ends 0 compare results/mine results/again
says 'my-accel:boxes=on +primary +[01]\.[0-9]+ .*by accelerator +same'
says_not 'plugin'
ends 2 reproduce results/mine
says "results/mine/manifest.json: 'my-accel' belonged to the plugin $work/old/mine.so \($hash\) then, and does not now"
says 'an accelerator of a plugin needs --plugin FILE.so'
ends 2 run results/mine/manifest.json --out results/other
says "'my-accel' belonged to the plugin .*mine.so.*no accelerator 'my-accel'"

# ---- other plugins ----

cp results/mine/cells.jsonl before.jsonl
ends 0 run mine.yaml --plugin old/mine.so --plugin "$plugins/bvh_copy.so" --resume
says 'nothing was left to measure'
cmp -s before.jsonl results/mine/cells.jsonl || complain 'with another plugin loaded the journal is another'
ends 0 reproduce results/mine --plugin old/mine.so
says_not 'has changed'

# ---- a plugin that has changed ----

ends 0 reproduce results/mine --plugin new/mine.so
both="the plugin of 'my-accel' has changed: $work/old/mine.so \($hash\) then, $work/new/mine.so \($hash\) now"
says "results/mine/manifest.json: $both"
ends 0 run results/mine/manifest.json --out results/newer --plugin new/mine.so
says "$both"
ends 0 compare results/mine results/newer
says "Note: the plugin of 'my-accel' has changed: .*old/mine.so \($hash\) before, .*new/mine.so \($hash\) after"
"$program" compare results/mine results/newer --json | python3 -c '
import json, sys
change = json.load(sys.stdin)["plugins"]["my-accel"]
sys.exit(change["before"]["hash"] == change["after"]["hash"] or len(change["after"]["hash"]) != 16)' ||
    complain 'compare --json does not name the plugin that has changed'
ends 0 run mine.yaml --plugin new/mine.so --resume --dry-run
says '16 cells, 8 of them finished'
ends 0 run mine.yaml --plugin new/mine.so --resume --force --dry-run
says '16 cells, 8 of them finished'
cmp -s before.jsonl results/mine/cells.jsonl || complain '--dry-run changed the journal'
ends 0 run mine.yaml --plugin new/mine.so --resume
says "'my-accel' has changed: .*old/mine.so.* when this run began, .*new/mine.so.* now: its cells are measured again"
python3 - <<'END_OF_PYTHON' || failures=$((failures + 1))
import json, sys

def load(name):
    header, *lines = [json.loads(line) for line in open(name)]
    mine = [line for line in lines if line.get("accel", "").startswith("my-accel")]
    return header, mine, [line for line in lines if line not in mine]

then, now = load("before.jsonl"), load("results/mine/cells.jsonl")
if then[2] != now[2]:
    print("--resume: what others did is not what it was")
if len(then[1]) != len(now[1]) or any(line in then[1] for line in now[1] if "timed" in line):
    print("--resume: the cells of the plugin are not measured again")
if then[0]["plugins"]["my-accel"]["hash"] == now[0]["plugins"]["my-accel"]["hash"]:
    print("--resume: the journal is of the plugin that was")
manifest = json.load(open("results/mine/manifest.json"))
if manifest["machine"]["plugins"][0]["hash"] != now[0]["plugins"]["my-accel"]["hash"]:
    print("--resume: the manifest is of the plugin that was")
sys.exit(then[2] != now[2] or len(then[1]) != len(now[1]) or then[0] == now[0])
END_OF_PYTHON
ends 0 run mine.yaml --plugin new/mine.so --resume
says 'nothing was left'
ends 0 reproduce results/mine --plugin new/mine.so
says_not 'has changed'

# If it is the baseline, no results could be kept.
ends 0 run based.yaml --plugin old/mine.so
cp results/based/cells.jsonl before.jsonl
ends 2 run based.yaml --plugin new/mine.so --resume
says 'this changes the baseline: replace this run with --force'
cmp -s before.jsonl results/based/cells.jsonl || complain 'a run that is refused changed the journal'

# ---- shards ----

ends 0 run mine.yaml --plugin old/mine.so --shard 1/2
ends 0 run mine.yaml --plugin old/mine.so --plugin "$plugins/bvh_copy.so" --shard 2/2
ends 2 merge results/mine-*-of-2 -o results/merged --plugin new/mine.so
says "mine-1-of-2: .*'my-accel' has changed: .*old/mine.so \($hash\) there, .*new/mine.so \($hash\) here: load that one"
ends 0 merge results/mine-*-of-2 -o results/merged --plugin old/mine.so
cmp -s results/mine/counts.csv results/merged/counts.csv || complain 'shards of a plugin count otherwise'

# ---- messages ----

bench=(bench balls:size=1 --rays primary --size 16x16 --rounds 1 --accel bvh --accel my-accel)
ends 2 "${bench[@]}"
says "no accelerator 'my-accel'.* an accelerator of a plugin needs --plugin FILE.so"
mkdir source
RAYTALLY_PLUGINS=source ends 2 "${bench[@]}"
says "RAYTALLY_PLUGINS: there is no \*\.so in source: .*source/build"
RAYTALLY_PLUGINS=old ends 0 "${bench[@]}" --distribution
says_not 'there is no \*\.so'
says 'Leaf size and depth of my-accel are unknown'
says_not 'Leaf size and depth of bvh'

conclude
