# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "light-buffer"
format = "svg"
scenes = "dragon-11k dragon-48k dragon-202k dragon-871k hall forest city lights-1 lights-2 lights-4 lights-8 "
accels = "wide light 256 512 1024 2048 "
colors = "#0072b2 #b2182b #620d18 #c34c5b #8a1321 #bb3243 "
markers = "7 5 9 11 13 6 "
dashes = "1 1 1 1 1 1 "
kinds = "shadow "
