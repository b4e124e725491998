# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "overview"
format = "svg"
paper = "page"
scenes = "balls gears jacks lattice mount rings shells teapot tetra tree scattered clustered soup stadium csg hall forest city jewel bunny "
files = "balls gears jacks lattice mount rings shells teapot tetra tree scattered clustered soup stadium csg hall forest city jewel bunny "
accels = "brute extents clusters grid octree kd bvh wide item+bvh light+bvh cache+bvh embree "
colors = "#7f7f7f #e69f00 #cc79a7 #009e73 #56b4e9 #5b4a9f #d55e00 #0072b2 #a6761d #b2182b #66a61e #7b3294 "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow reflection transmission diffuse random "
sets = "balls/primary=3286 balls/shadow=3968 balls/reflection=3596 balls/diffuse=3286 balls/random=4000 gears/primary=3286 gears/shadow=3906 gears/reflection=3782 gears/transmission=3162 gears/diffuse=3816 gears/random=4000 jacks/primary=3286 jacks/shadow=2997 jacks/reflection=3720 jacks/diffuse=2232 jacks/random=4000 lattice/primary=3286 lattice/shadow=3782 lattice/reflection=3720 lattice/diffuse=3245 lattice/random=4000 mount/primary=3286 mount/shadow=3720 mount/reflection=3720 mount/transmission=3720 mount/diffuse=3596 mount/random=4000 rings/primary=3286 rings/shadow=3968 rings/reflection=3906 rings/diffuse=3286 rings/random=4000 shells/primary=3286 shells/shadow=2666 shells/reflection=2728 shells/diffuse=2480 shells/random=4000 teapot/primary=3286 teapot/shadow=3596 teapot/reflection=3534 teapot/diffuse=3387 teapot/random=4000 tetra/primary=3286 tetra/shadow=2898 tetra/diffuse=3139 tetra/random=4000 tree/primary=3286 tree/shadow=3782 tree/diffuse=3534 tree/random=4000 scattered/primary=3286 scattered/shadow=3472 scattered/reflection=3534 scattered/transmission=3782 scattered/diffuse=2827 scattered/random=4000 clustered/primary=3286 clustered/shadow=2971 clustered/reflection=3713 clustered/transmission=2651 clustered/diffuse=2150 clustered/random=4000 soup/primary=3286 soup/shadow=3597 soup/reflection=1264 soup/transmission=466 soup/diffuse=2107 soup/random=4000 stadium/primary=3286 stadium/shadow=3720 stadium/reflection=937 stadium/diffuse=3782 stadium/random=4000 csg/primary=3286 csg/shadow=3038 csg/reflection=1110 csg/diffuse=3686 csg/random=4000 hall/primary=3286 hall/shadow=3906 hall/reflection=2575 hall/diffuse=3286 hall/random=4000 forest/primary=3286 forest/shadow=3410 forest/diffuse=3720 forest/random=4000 city/primary=3286 city/shadow=3782 city/reflection=2155 city/diffuse=3968 city/random=4000 jewel/primary=3286 jewel/shadow=3906 jewel/reflection=3410 jewel/transmission=1588 jewel/diffuse=3398 jewel/random=4000 bunny/primary=3286 bunny/shadow=3314 bunny/diffuse=3357 bunny/random=4000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
