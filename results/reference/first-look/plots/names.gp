# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "first-look"
format = "svg"
scenes = "balls jewel bunny "
accels = "brute extents grid bvh embree-user embree ideal "
colors = "#7f7f7f #e69f00 #009e73 #d55e00 #7b3294 #441c51 #222222 "
markers = "7 5 9 11 13 6 4 "
dashes = "1 1 1 1 1 1 1 "
kinds = "primary shadow reflection transmission diffuse random "
