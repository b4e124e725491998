# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "light-buffer"
format = "svg"
paper = "page"
scenes = "dragon-11k dragon-48k dragon-202k dragon-871k hall forest city lights-1 lights-2 lights-4 lights-8 "
files = "dragon-11k dragon-48k dragon-202k dragon-871k hall forest city lights-1 lights-2 lights-4 lights-8 "
accels = "wide light 256 512 1024 2048 "
colors = "#0072b2 #b2182b #3e080f #78101d #cb6370 #e4aeb5 "
markers = "7 5 9 11 13 6 "
dashes = "1 1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "shadow "
sets = "dragon-11k/shadow=196026 dragon-48k/shadow=199069 dragon-202k/shadow=198680 dragon-871k/shadow=198635 hall/shadow=243712 forest/shadow=249856 city/shadow=234949 lights-1/shadow=178176 lights-2/shadow=244736 lights-4/shadow=233472 lights-8/shadow=256526 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
