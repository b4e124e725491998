# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "embree"
format = "svg"
scenes = "bunny dragon hall forest balls "
accels = "wide wide-reinserted bvh embree-1-medium-avx2 embree-8-medium-avx2 embree-16-medium-avx2 embree-stream-medium-avx2 embree-1-high-avx2 embree-8-high-avx2 embree-16-high-avx2 embree-stream-high-avx2 embree-1-medium-avx512 embree-8-medium-avx512 embree-16-medium-avx512 embree-stream-medium-avx512 embree-1-high-avx512 embree-8-high-avx512 embree-16-high-avx512 embree-stream-high-avx512 "
colors = "#0072b2 #003f62 #d55e00 #7b3294 #441c51 #9960ac #5f2773 #8a49a0 #512162 #a877b8 #6d2c83 #823e9a #4b1e5a #a06cb2 #662a7b #9155a6 #58246a #af83be #742f8c "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 6 4 8 10 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 2 2 2 2 "
kinds = "primary shadow diffuse occlusion random "
