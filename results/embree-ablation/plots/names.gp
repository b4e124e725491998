# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "embree-ablation"
format = "svg"
scenes = "bunny dragon hall forest "
accels = "wide no-packets packets-always one-packet-at-a-time 4-rays-in-flight one-ray-at-a-time children-in-any-order nothing-fetched-ahead small-pages leaves-of-2 leaves-of-8 AVX2 portable reinsertion spatial-splits "
colors = "#0072b2 #003f62 #3992c3 #00588a #1d82bb #004c76 #56a2cc #00659e #0e7ab6 #00456c #489ac8 #005f94 #2b8abf #005280 #64aad0 "
markers = "7 5 9 11 13 6 4 8 10 12 7 5 9 11 13 "
dashes = "1 1 1 1 1 1 1 1 1 1 2 2 2 2 2 "
kinds = "primary shadow diffuse occlusion random "
