# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "weghorst-1984"
format = "svg"
paper = "page"
scenes = "balls gears mount rings teapot tetra tree "
files = "balls gears mount rings teapot tetra tree "
accels = "hierarchy item "
colors = "#cc79a7 #a6761d "
markers = "7 5 "
dashes = "1 1 "
groups = "\"\" \"\" "
without = ""
among = ""
kinds = "primary shadow reflection transmission "
sets = "balls/primary=65536 balls/shadow=59392 balls/reflection=44168 gears/primary=65536 gears/shadow=62464 gears/reflection=38090 gears/transmission=50242 mount/primary=65536 mount/shadow=51968 mount/reflection=44582 mount/transmission=44582 rings/primary=65536 rings/shadow=54016 rings/reflection=39424 teapot/primary=65536 teapot/shadow=50944 teapot/reflection=56406 tetra/primary=65536 tetra/shadow=11607 tree/primary=65536 tree/shadow=54784 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
