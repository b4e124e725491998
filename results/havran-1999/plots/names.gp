# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "havran-1999"
scenes = "balls lattice mount tetra tree "
accels = "bvh clusters kd item+light+bvh grid-woo-1 grid-woo-10 grid-custom recursive-h-2 recursive-h-3 recursive-r-2 recursive-r-3 84-C-4 84-C-5 84-C-6 84-C-7 84-A-4 84-A-5 84-A-6 84-A-7 89-C-4 89-C-5 89-C-6 89-C-7 93-C-4 93-C-5 93-C-6 93-C-7 93-A-4 93-A-5 93-A-6 93-A-7 "
colors = "#8c8c8c #e69f00 #009e73 #0072b2 #56b4e9 #d55e00 #cc79a7 #5b4a9f #a6761d #66a61e #b2182b #17becf #8c8c8c #e69f00 #009e73 #0072b2 #56b4e9 #d55e00 #cc79a7 #5b4a9f #a6761d #66a61e #b2182b #17becf #8c8c8c #e69f00 #009e73 #0072b2 #56b4e9 #d55e00 #cc79a7 "
kinds = "primary shadow reflection transmission "
