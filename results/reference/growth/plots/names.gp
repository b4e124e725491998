# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "growth"
format = "svg"
paper = "page"
scenes = "spheres:n=100 spheres:n=1000 spheres:n=10000 spheres:n=100000 spheres:n=1000000 spheres:n=10000000 "
files = "spheres-n-100 spheres-n-1000 spheres-n-10000 spheres-n-100000 spheres-n-1000000 spheres-n-10000000 "
accels = "brute extents clusters octree kd grid bvh bvh-sweep bvh-lbvh bvh-ploc bvh-spatial bvh-reinsertion wide embree "
colors = "#7f7f7f #e69f00 #cc79a7 #56b4e9 #5b4a9f #009e73 #d55e00 #4b2100 #793500 #a74a00 #e39253 #f0c7a6 #0072b2 #7b3294 "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary random "
sets = "spheres:n=100/primary=2046 spheres:n=100/random=4000 spheres:n=1000/primary=2046 spheres:n=1000/random=4000 spheres:n=10000/primary=2046 spheres:n=10000/random=4000 spheres:n=100000/primary=2046 spheres:n=100000/random=4000 spheres:n=1000000/primary=2046 spheres:n=1000000/random=4000 spheres:n=10000000/primary=2046 spheres:n=10000000/random=4000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
