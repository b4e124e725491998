# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "prediction"
format = "svg"
paper = "page"
scenes = "points spheres balls tetra mount lattice tree stadium soup crowd bunny dragon hall forest "
files = "points spheres balls tetra mount lattice tree stadium soup crowd bunny dragon hall forest "
accels = "box grid-0.25 grid-1 grid-4 grid-16 grid-64 grid-nested octree-4 octree-6 octree-8 kd bvh bvh-sweep bvh-lbvh agglomerative rubin-whitted bvh-ploc bvh-spatial bvh-reinserted bvh-lbvh-reinserted bvh-3-bins clusters-agglomerative clusters-ploc clusters-ploc-2 clusters-sah clusters-rubin-whitted clusters-inserted clusters-as-given wide wide-sweep wide-lbvh wide-ploc wide-spatial wide-reinserted wide-lbvh-reinserted wide-3-bins "
colors = "#009e73 #003728 #005a41 #007c5a #37b391 #6fc8b0 #a6ddce #56b4e9 #1e3f52 #c4e5f7 #5b4a9f #d55e00 #4b2100 #6d3000 #cc79a7 #472a3a #903f00 #b24f00 #de8137 #e7a46f #f0c7a6 #693e56 #8a5271 #ab658c #d48fb5 #dda5c4 #e5bad2 #edd0e0 #0072b2 #00283e #003a5b #004d78 #005f95 #3791c3 #6fafd3 #a6cee4 "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 2 2 2 3 3 3 3 3 3 3 3 3 3 4 4 4 4 4 4 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse random "
sets = "points/primary=9363 points/shadow=238 points/diffuse=118 points/random=10000 spheres/primary=9363 spheres/shadow=8726 spheres/diffuse=7589 spheres/random=10000 balls/primary=9363 balls/shadow=9681 balls/diffuse=9363 balls/random=10000 tetra/primary=9363 tetra/shadow=5804 tetra/diffuse=6255 tetra/random=10000 mount/primary=9363 mount/shadow=9906 mount/diffuse=8679 mount/random=10000 lattice/primary=9363 lattice/shadow=9712 lattice/diffuse=9292 lattice/random=10000 tree/primary=9363 tree/shadow=9765 tree/diffuse=8468 tree/random=10000 stadium/primary=9363 stadium/shadow=9383 stadium/diffuse=8647 stadium/random=10000 soup/primary=9363 soup/shadow=7341 soup/diffuse=9902 soup/random=10000 crowd/primary=9363 crowd/shadow=6629 crowd/diffuse=4472 crowd/random=10000 bunny/primary=9363 bunny/shadow=6628 bunny/diffuse=6713 bunny/random=10000 dragon/primary=9363 dragon/shadow=6211 dragon/diffuse=6286 dragon/random=10000 hall/primary=9363 hall/shadow=9712 hall/diffuse=9363 hall/random=10000 forest/primary=9363 forest/shadow=9782 forest/diffuse=8806 forest/random=10000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
