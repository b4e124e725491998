# SPDX-License-Identifier: Apache-2.0
# Run by cpack between collecting the files of a package, in CPACK_TEMPORARY_DIRECTORY, and packing them.
cmake_minimum_required(VERSION 3.25)
set(source ${CMAKE_CURRENT_LIST_DIR}/..)

if(CPACK_GENERATOR STREQUAL "DEB") # where and how Debian wants them
  set(share ${CPACK_TEMPORARY_DIRECTORY}/usr/share)
  set(doc ${share}/doc/raytally)
  file(REMOVE ${doc}/LICENSE)
  file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/copyright ${doc}/copyright)
  file(READ ${doc}/README.md readme)
  string(REPLACE "](LICENSE)" "](copyright)" readme "${readme}")
  file(WRITE ${doc}/README.md "${readme}")
  string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
  file(WRITE ${doc}/changelog.Debian "raytally (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=low

  * CHANGELOG.md says what is new.

 -- ${CPACK_PACKAGE_CONTACT}  ${now}
")
  file(GLOB pages ${share}/man/man1/*.1)
  execute_process(COMMAND gzip -9n ${doc}/changelog.Debian ${pages} COMMAND_ERROR_IS_FATAL ANY)
  file(GLOB_RECURSE archives ${CPACK_TEMPORARY_DIRECTORY}/usr/lib/*.a)
  execute_process(COMMAND strip --strip-debug ${archives} COMMAND_ERROR_IS_FATAL ANY)
else() # the files of the commit, which git writes to cmake/commit.txt
  file(GLOB collected ${CPACK_TEMPORARY_DIRECTORY}/*)
  file(REMOVE_RECURSE ${collected})
  execute_process(COMMAND git -C ${source} archive HEAD
    COMMAND tar -x -C ${CPACK_TEMPORARY_DIRECTORY} COMMAND_ERROR_IS_FATAL ANY)
endif()
