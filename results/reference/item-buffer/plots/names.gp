# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "item-buffer"
format = "svg"
paper = "page"
scenes = "bunny-256 bunny-1024 bunny-2048 hall-256 hall-1024 hall-2048 forest-1024 dragon-1024 dragon11k-1024 dragon48k-1024 dragon202k-1024 "
files = "bunny-256 bunny-1024 bunny-2048 hall-256 hall-1024 hall-2048 forest-1024 dragon-1024 dragon11k-1024 dragon48k-1024 dragon202k-1024 "
accels = "item wide embree-1-medium-avx2 embree-8-medium-avx2 embree-16-medium-avx2 embree-stream-medium-avx2 embree-1-high-avx2 embree-8-high-avx2 embree-16-high-avx2 embree-stream-high-avx2 embree-1-medium-avx512 embree-8-medium-avx512 embree-16-medium-avx512 embree-stream-medium-avx512 embree-1-high-avx512 embree-8-high-avx512 embree-16-high-avx512 embree-stream-high-avx512 "
colors = "#a6761d #0072b2 #7b3294 #2b1234 #351640 #3f1a4c #491e58 #532264 #5d2670 #672a7c #712e88 #87459e #9458a8 #a06bb2 #ac7ebc #b891c6 #c5a4d0 #d1b7da "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 2 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary "
sets = "bunny-256/primary=65536 bunny-1024/primary=1048576 bunny-2048/primary=4194304 hall-256/primary=65536 hall-1024/primary=1048576 hall-2048/primary=4194304 forest-1024/primary=1048576 dragon-1024/primary=1048576 dragon11k-1024/primary=1048576 dragon48k-1024/primary=1048576 dragon202k-1024/primary=1048576 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
