# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "item-buffer"
format = "svg"
scenes = "bunny-256 bunny-512 bunny-1024 bunny-2048 hall-256 hall-512 hall-1024 hall-2048 forest-256 forest-512 forest-1024 forest-2048 dragon-256 dragon-512 dragon-1024 dragon-2048 dragon11k-1024 dragon48k-1024 dragon202k-1024 "
accels = "item wide embree-1-medium-avx2 embree-8-medium-avx2 embree-16-medium-avx2 embree-stream-medium-avx2 embree-1-high-avx2 embree-8-high-avx2 embree-16-high-avx2 embree-stream-high-avx2 embree-1-medium-avx512 embree-8-medium-avx512 embree-16-medium-avx512 embree-stream-medium-avx512 embree-1-high-avx512 embree-8-high-avx512 embree-16-high-avx512 embree-stream-high-avx512 "
colors = "#a6761d #0072b2 #7b3294 #441c51 #9960ac #5f2773 #8a49a0 #512162 #a877b8 #6d2c83 #823e9a #4b1e5a #a06cb2 #662a7b #9155a6 #58246a #af83be #742f8c "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 2 "
kinds = "primary "
