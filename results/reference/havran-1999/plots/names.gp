# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "havran-1999"
format = "svg"
scenes = "balls lattice mount tetra tree "
accels = "bvh clusters kd item+light+bvh grid-woo-1 grid-woo-10 grid-custom recursive-h-2 recursive-h-3 recursive-r-2 recursive-r-3 84-C-4 84-C-5 84-C-6 84-C-7 84-A-4 84-A-5 84-A-6 84-A-7 89-C-4 89-C-5 89-C-6 89-C-7 93-C-4 93-C-5 93-C-6 93-C-7 93-A-4 93-A-5 93-A-6 93-A-7 "
colors = "#d55e00 #cc79a7 #5b4a9f #a6761d #009e73 #00573f #39b493 #00956d #07a177 #005b42 #41b796 #56b4e9 #2f6380 #7cc5ee #438cb5 #5bb6ea #326887 #81c7ef #4591bb #58b5e9 #316683 #7ec6ee #448eb8 #5db7ea #336b8a #83c8ef #4693be #57b5e9 #306482 #7dc5ee #438db6 "
markers = "7 5 9 11 13 6 4 12 7 5 9 11 13 6 4 12 7 5 9 6 4 8 10 5 9 11 13 8 10 12 7 "
dashes = "1 1 1 1 1 1 1 2 3 3 3 3 3 3 3 4 5 5 5 1 1 1 1 3 3 3 3 4 4 4 5 "
kinds = "primary shadow reflection transmission "
