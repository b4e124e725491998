# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "octree-grid"
format = "svg"
paper = "page"
scenes = "uniform:n=1000 uniform:n=10000 uniform:n=100000 clustered:width=0.0125 clustered:width=0.025 clustered:width=0.05 clustered:width=0.1 clustered:width=0.2 clustered:width=0.4 stadium:ratio=50 stadium:ratio=400 stadium:ratio=3200 stadium:ratio=25600 "
files = "uniform-n-1000 uniform-n-10000 uniform-n-100000 clustered-width-0.0125 clustered-width-0.025 clustered-width-0.05 clustered-width-0.1 clustered-width-0.2 clustered-width-0.4 stadium-ratio-50 stadium-ratio-400 stadium-ratio-3200 stadium-ratio-25600 "
accels = "grid octree deep nested "
colors = "#009e73 #56b4e9 #1e3f52 #003728 "
markers = "7 5 9 11 "
dashes = "1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow diffuse "
sets = "uniform:n=1000/primary=4096 uniform:n=1000/shadow=2816 uniform:n=1000/diffuse=3811 uniform:n=10000/primary=4096 uniform:n=10000/shadow=3840 uniform:n=10000/diffuse=2609 uniform:n=100000/primary=4096 uniform:n=100000/shadow=4416 uniform:n=100000/diffuse=3008 clustered:width=0.0125/primary=4096 clustered:width=0.0125/shadow=361 clustered:width=0.0125/diffuse=245 clustered:width=0.025/primary=4096 clustered:width=0.025/shadow=758 clustered:width=0.025/diffuse=500 clustered:width=0.05/primary=4096 clustered:width=0.05/shadow=1621 clustered:width=0.05/diffuse=1086 clustered:width=0.1/primary=4096 clustered:width=0.1/shadow=2897 clustered:width=0.1/diffuse=1986 clustered:width=0.2/primary=4096 clustered:width=0.2/shadow=3457 clustered:width=0.2/diffuse=2380 clustered:width=0.4/primary=4096 clustered:width=0.4/shadow=2516 clustered:width=0.4/diffuse=1702 stadium:ratio=50/primary=4096 stadium:ratio=50/shadow=4736 stadium:ratio=50/diffuse=4608 stadium:ratio=400/primary=4096 stadium:ratio=400/shadow=4480 stadium:ratio=400/diffuse=3712 stadium:ratio=3200/primary=4096 stadium:ratio=3200/shadow=4544 stadium:ratio=3200/diffuse=3840 stadium:ratio=25600/primary=4096 stadium:ratio=25600/shadow=4544 stadium:ratio=25600/diffuse=3840 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
