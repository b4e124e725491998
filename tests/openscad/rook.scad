// SPDX-License-Identifier: Apache-2.0
// The white rook of scenes/chess.yaml on the first square of its row.
include <pieces.scad>
translate([-3.5, -3.5, 0.001]) {
    foot();
    cone(0.1, 0.28, 0.66, 0.2);
    difference() {
        cone(0.64, 0.27, 0.9, 0.27);
        cone(0.74, 0.18, 1, 0.18);
        block([-0.4, -0.05, 0.79], [0.4, 0.05, 1]);
        rotate(90) block([-0.4, -0.05, 0.79], [0.4, 0.05, 1]);
    }
}
