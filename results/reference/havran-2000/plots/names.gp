# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "havran-2000"
format = "svg"
paper = "page"
scenes = "balls gears jacks lattice mount rings shells teapot tetra tree "
files = "balls gears jacks lattice mount rings shells teapot tetra tree "
accels = "kd grid grid-recursive octree-centre octree-cost hierarchy-1987 hierarchy-2007 "
colors = "#5b4a9f #009e73 #003728 #56b4e9 #1e3f52 #cc79a7 #d55e00 "
markers = "7 5 9 11 13 6 4 "
dashes = "1 1 1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow reflection transmission "
sets = "balls/primary=4672 balls/shadow=4928 balls/reflection=4928 gears/primary=4672 gears/shadow=4992 gears/reflection=4736 gears/transmission=4546 jacks/primary=4672 jacks/shadow=4928 jacks/reflection=4296 lattice/primary=4672 lattice/shadow=4928 lattice/reflection=4928 mount/primary=4672 mount/shadow=4928 mount/reflection=4928 mount/transmission=4928 rings/primary=4672 rings/shadow=4928 rings/reflection=4928 shells/primary=4672 shells/shadow=4224 shells/reflection=4416 teapot/primary=4672 teapot/shadow=4864 teapot/reflection=4672 tetra/primary=4672 tetra/shadow=3863 tree/primary=4672 tree/shadow=4992 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
