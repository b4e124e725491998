/* SPDX-License-Identifier: Apache-2.0 */
/* The program that each library of a directory is linked into, whole: see raytally_library in CMakeLists.txt.
 */
int main(void) {
    return 0;
}
