# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "embree"
scenes = "bunny dragon hall forest balls "
accels = "wide wide-reinserted bvh embree-1-medium-avx2 embree-8-medium-avx2 embree-16-medium-avx2 embree-stream-medium-avx2 embree-1-high-avx2 embree-8-high-avx2 embree-16-high-avx2 embree-stream-high-avx2 embree-1-medium-avx512 embree-8-medium-avx512 embree-16-medium-avx512 embree-stream-medium-avx512 embree-1-high-avx512 embree-8-high-avx512 embree-16-high-avx512 embree-stream-high-avx512 "
colors = "#8c8c8c #e69f00 #009e73 #0072b2 #56b4e9 #d55e00 #cc79a7 #5b4a9f #a6761d #66a61e #b2182b #17becf #8c8c8c #e69f00 #009e73 #0072b2 #56b4e9 #d55e00 #cc79a7 "
kinds = "primary shadow diffuse occlusion random "
