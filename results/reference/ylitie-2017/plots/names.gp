# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "ylitie-2017"
format = "svg"
paper = "page"
scenes = "dragon-11k dragon-48k dragon-202k dragon-871k hall "
files = "dragon-11k dragon-48k dragon-202k dragon-871k hall "
accels = "binary wide-one-ray wide-no-prefetch wide-in-flight "
colors = "#d55e00 #0072b2 #00283e #a6cee4 "
markers = "7 5 9 11 "
dashes = "1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "diffuse random "
sets = "dragon-11k/diffuse=12374 dragon-11k/random=20000 dragon-48k/diffuse=12601 dragon-48k/random=20000 dragon-202k/diffuse=12559 dragon-202k/random=20000 dragon-871k/diffuse=12571 dragon-871k/random=20000 hall/diffuse=16384 hall/random=20000 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
