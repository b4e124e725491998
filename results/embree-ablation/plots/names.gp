# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "embree-ablation"
scenes = "bunny dragon hall forest "
accels = "wide no-packets packets-always one-packet-at-a-time 4-rays-in-flight one-ray-at-a-time children-in-any-order nothing-fetched-ahead small-pages leaves-of-2 leaves-of-8 AVX2 portable reinsertion spatial-splits "
colors = "#8c8c8c #e69f00 #009e73 #0072b2 #56b4e9 #d55e00 #cc79a7 #5b4a9f #a6761d #66a61e #b2182b #17becf #8c8c8c #e69f00 #009e73 "
kinds = "primary shadow diffuse occlusion random "
