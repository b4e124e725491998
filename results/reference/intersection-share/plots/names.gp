# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "intersection-share"
format = "svg"
paper = "page"
scenes = "spheres:n=10 spheres:n=100 spheres:n=1000 spheres:n=10000 spheres:n=100000 balls teapot bunny "
files = "spheres-n-10 spheres-n-100 spheres-n-1000 spheres-n-10000 spheres-n-100000 balls teapot bunny "
accels = "brute extents bvh wide "
colors = "#7f7f7f #e69f00 #d55e00 #0072b2 "
markers = "7 5 9 11 "
dashes = "1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow reflection transmission "
sets = "spheres:n=10/primary=8192 spheres:n=10/shadow=2162 spheres:n=10/reflection=321 spheres:n=100/primary=8192 spheres:n=100/shadow=7043 spheres:n=100/reflection=3345 spheres:n=100/transmission=2317 spheres:n=1000/primary=8192 spheres:n=1000/shadow=7365 spheres:n=1000/reflection=6806 spheres:n=1000/transmission=5092 spheres:n=10000/primary=8192 spheres:n=10000/shadow=7296 spheres:n=10000/reflection=9798 spheres:n=10000/transmission=7192 spheres:n=100000/primary=8192 spheres:n=100000/shadow=8832 spheres:n=100000/reflection=5669 spheres:n=100000/transmission=8267 balls/primary=8192 balls/shadow=9856 balls/reflection=5479 teapot/primary=8192 teapot/shadow=8448 teapot/reflection=7040 bunny/primary=8192 bunny/shadow=3314 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
