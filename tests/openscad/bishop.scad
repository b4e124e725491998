// SPDX-License-Identifier: Apache-2.0
// The white bishop of scenes/chess.yaml on the third square of its row.
include <pieces.scad>
translate([-1.5, -3.5, 0.001]) {
    foot();
    cone(0.1, 0.26, 0.72, 0.1);
    egg([0, 0, 0.72], [0.2, 0.2, 0.05]);
    difference() {
        egg([0, 0, 0.93], [0.16, 0.16, 0.24]);
        translate([0.02, 0, 0.95]) rotate([0, 35, 0]) block([-0.018, -1, 0], [0.018, 1, 0.5]);
    }
    ball([0, 0, 1.19], 0.05);
}
