// SPDX-License-Identifier: Apache-2.0
// What the chessmen of scenes/chess.yaml share, written a second time by hand.
$fn = 48;
module ball(at, r) { translate(at) sphere(r); }
module egg(at, r) { translate(at) scale(r) sphere(1); }
module cone(z0, r0, z1, r1) { translate([0, 0, z0]) cylinder(h = z1 - z0, r1 = r0, r2 = r1); }
module ring(z, major, minor) { translate([0, 0, z]) rotate_extrude() translate([major, 0]) circle(minor); }
module block(lo, hi) { translate(lo) cube(hi - lo); }
module foot() {
    cone(0, 0.36, 0.1, 0.36);
    ring(0.1, 0.29, 0.07);
}
