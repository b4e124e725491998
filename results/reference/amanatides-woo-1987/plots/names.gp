# What counts.csv and times.csv have rows of, in the order of the experiment.
experiment = "amanatides-woo-1987"
format = "svg"
paper = "page"
scenes = "lecture jewel teapot gears "
files = "lecture jewel teapot gears "
accels = "20-boxes 20-boxes-mailbox 20-surfaces 20-surfaces-mailbox 40-boxes 40-boxes-mailbox 40-surfaces 40-surfaces-mailbox "
colors = "#009e73 #003728 #00513b #006b4e #008460 #37b391 #6fc8b0 #a6ddce "
markers = "7 5 9 11 13 6 4 8 "
dashes = "1 1 1 1 1 1 1 1 "
groups = "\"\" \"\" \"\" \"\" \"\" \"\" \"\" \"\" "
without = ""
among = ""
kinds = "primary shadow "
sets = "lecture/primary=22016 lecture/shadow=25856 jewel/primary=22016 jewel/shadow=25600 teapot/primary=22016 teapot/shadow=23040 gears/primary=22016 gears/shadow=29440 "
whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \
  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))
weight(unused) = whole_rays(strcol('scene'), strcol('kind'))
