# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "prediction"
format = "svg"
scenes = "points spheres balls tetra mount lattice tree stadium soup crowd bunny dragon hall forest "
accels = "box grid-0.25 grid-1 grid-4 grid-16 grid-64 grid-nested octree-4 octree-6 octree-8 kd bvh bvh-sweep bvh-lbvh agglomerative rubin-whitted bvh-ploc bvh-spatial bvh-reinserted bvh-lbvh-reinserted bvh-3-bins clusters-agglomerative clusters-ploc clusters-ploc-2 clusters-sah clusters-rubin-whitted clusters-inserted clusters-as-given wide wide-sweep wide-lbvh wide-ploc wide-spatial wide-reinserted wide-lbvh-reinserted wide-3-bins "
colors = "#009e73 #00573f #39b493 #007a59 #1da983 #00694c #56bfa2 #56b4e9 #2f6380 #7cc5ee #5b4a9f #d55e00 #753400 #de8239 #cc79a7 #70435c #a54900 #da701d #8d3e00 #e39456 #bd5300 #d797bb #9e5e81 #d288b1 #87506f #dda6c5 #b56b94 #cf81ac #0072b2 #003f62 #3992c3 #00588a #1d82bb #004c76 #56a2cc #00659e "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 2 2 2 3 3 3 3 3 3 3 3 3 3 4 4 4 4 4 4 "
kinds = "primary shadow diffuse random "
