#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# check_layers.sh [TREE]: includes go one way only, and nothing but the registry and its own file or folder knows a
# concrete accelerator: names its operations, includes from its folder or, outside accel/, opens it by its name; tests
# may include and open. Prints each violation and fails where there is one.
set -euo pipefail
rooms=$(cat "$(dirname "$0")/rooms.txt") # a room may include itself and those before it
cd "${1:-$(dirname "$0")/..}"

# shellcheck disable=SC2016 # the dollars are awk's
find src accel scenes tests -name '*.[ch]' | sort | xargs awk -v rooms="$rooms" '
    BEGIN {
        split(rooms, list, " ")
        for (i = 1; i in list; i++) level[list[i]] = i
    }
    function room_of(path,    part) {
        sub(/^(src\/)?(core\/)?/, "", path)
        split(path, part, "/")
        return part[1]
    }
    function report(what) {
        print FILENAME ":" FNR ": " what
        wrong = 1
    }
    function near(path, home) { # in its file, or in its folder where it has one of its own
        if (path == home) return 1
        sub(/[^\/]*$/, "", home)
        return home != "accel/" && index(path, home) == 1
    }
    /^[ \t]*#[ \t]*include[ \t]*"/ {
        split($0, quoted, "\"")
        from = room_of(FILENAME)
        to = quoted[2] ~ /\// ? room_of(quoted[2]) : from
        if (!(from in level)) report("the room " from "/ is not in the order of rooms.txt")
        else if (!(to in level)) report("includes \"" quoted[2] "\", which lies in no room")
        else if (to == "accel" && from !~ /^(accel|tests)$/ && quoted[2] ~ /\/.*\//)
            report("includes \"" quoted[2] "\", from the folder of one accelerator")
        else if (level[to] > level[from]) report(from "/ includes \"" quoted[2] "\", a room above it")
    }
    FILENAME ~ /^src\// && !/^ \*/ { # "NAME", "NAME:KEY=VALUE" and "OVERLAY+NAME"; parameters and keys can be called like one
        rest = $0
        sub(/\/\*.*/, "", rest)
        while (match(rest, /"[a-z]+[^" ]*"/)) {
            spec[++specs] = substr(rest, RSTART + 1, RLENGTH - 2)
            opened[specs] = $0 ~ /rt_(accel_open|accel_find|spec_parse)[(]"/
            spec_file[specs] = FILENAME
            spec_line[specs] = FNR
            rest = substr(rest, RSTART + RLENGTH)
        }
    }
    { # an accelerator defines rt_NAME_ops in one file; note where it is named
        rest = $0
        while (match(rest, /rt_[a-z0-9_]+_ops/)) {
            name = substr(rest, RSTART, RLENGTH)
            rest = substr(rest, RSTART + RLENGTH)
            if (rest ~ /^ = [{]/) home[name] = FILENAME
            named[++names] = name
            file[names] = FILENAME
            line[names] = FNR
        }
    }
    END {
        for (i = 1; i <= names; i++) {
            if (!(named[i] in home) || file[i] == "accel/registry.c" || near(file[i], home[named[i]])) continue
            print file[i] ":" line[i] ": names " named[i] ", which belongs to " home[named[i]] " and the registry"
            wrong = 1
        }
        split("cache clusters extents item light", list, " ")
        for (i in list) common["rt_" list[i] "_ops"] = 1
        for (i = 1; i <= specs; i++) {
            count = split(spec[i], layers, "+")
            for (k = 1; k <= count; k++) {
                ops = "rt_" layers[k] "_ops"
                sub(/:.*_ops$/, "_ops", ops)
                if (!(ops in home) || (ops in common && !opened[i])) continue
                print spec_file[i] ":" spec_line[i] ": knows \"" spec[i] "\": ask the registry for what it can do"
                wrong = 1
            }
        }
        exit wrong
    }'
