# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "havran-1999"
format = "svg"
paper = "page"
scenes = "balls lattice mount tetra tree "
files = "balls lattice mount tetra tree "
accels = "bvh clusters kd item+light+bvh grid-woo-1 grid-woo-10 grid-custom recursive-h-2 recursive-h-3 recursive-r-2 recursive-r-3 84-C-4 84-C-5 84-C-6 84-C-7 84-A-4 84-A-5 84-A-6 84-A-7 89-C-4 89-C-5 89-C-6 89-C-7 93-C-4 93-C-5 93-C-6 93-C-7 93-A-4 93-A-5 93-A-6 93-A-7 "
colors = "#d55e00 #cc79a7 #5b4a9f #a6761d #009e73 #003728 #004331 #6fc8b0 #81cfba #93d6c4 #a6ddce #56b4e9 #1e3f52 #1f4255 #214559 #336b8a #346e8e #367192 #377496 #499ac7 #4b9dcb #4ca0ce #4ea2d2 #6dbeec #6fbfec #72c1ed #75c2ed #9ad2f2 #9cd3f2 #9fd5f3 #a2d6f3 "
markers = "7 5 9 11 13 6 4 12 7 5 9 11 13 6 4 12 7 5 9 6 4 8 10 5 9 11 13 8 10 12 7 "
dashes = "1 1 1 1 1 1 1 2 3 3 3 3 3 3 3 4 5 5 5 1 1 1 1 3 3 3 3 4 4 4 5 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow reflection transmission "
sets = "balls/primary=263169 balls/shadow=954973 balls/reflection=175939 lattice/primary=263169 lattice/shadow=1163985 lattice/reflection=236982 mount/primary=263169 mount/shadow=363349 mount/reflection=356188 mount/transmission=356188 tetra/primary=263169 tetra/shadow=46260 tree/primary=263169 tree/shadow=1097837 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
