# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "prediction"
scenes = "points spheres balls tetra mount lattice tree stadium soup crowd bunny dragon hall forest "
accels = "box grid-0.25 grid-1 grid-4 grid-16 grid-64 grid-nested octree-4 octree-6 octree-8 kd bvh bvh-sweep bvh-lbvh agglomerative rubin-whitted bvh-ploc bvh-spatial bvh-reinserted bvh-lbvh-reinserted bvh-3-bins clusters-agglomerative clusters-ploc clusters-ploc-2 clusters-sah clusters-rubin-whitted clusters-inserted clusters-as-given wide wide-sweep wide-lbvh wide-ploc wide-spatial wide-reinserted wide-lbvh-reinserted wide-3-bins "
colors = "#8c8c8c #e69f00 #009e73 #0072b2 #56b4e9 #d55e00 #cc79a7 #5b4a9f #a6761d #66a61e #b2182b #17becf #8c8c8c #e69f00 #009e73 #0072b2 #56b4e9 #d55e00 #cc79a7 #5b4a9f #a6761d #66a61e #b2182b #17becf #8c8c8c #e69f00 #009e73 #0072b2 #56b4e9 #d55e00 #cc79a7 #5b4a9f #a6761d #66a61e #b2182b #17becf "
kinds = "primary shadow diffuse random "
