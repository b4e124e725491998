# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "first-look"
scenes = "balls jewel bunny "
accels = "brute extents grid bvh embree-user embree ideal "
colors = "#8c8c8c #e69f00 #009e73 #0072b2 #56b4e9 #d55e00 #cc79a7 "
kinds = "primary shadow reflection transmission diffuse random "
