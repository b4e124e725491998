# SPDX-License-Identifier: Apache-2.0
# Documents and data, and packages of what is installed. The target `deb` makes a .deb for the Debian that it runs on; the
# target `package_source` an archive of the commit.
install(FILES CHANGELOG.md CITATION.cff LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} PATTERN Doxyfile EXCLUDE PATTERN "*.sh" EXCLUDE PATTERN slides EXCLUDE)
install(DIRECTORY experiments DESTINATION ${CMAKE_INSTALL_DATADIR}/raytally USE_SOURCE_PERMISSIONS)
file(GLOB scenes CONFIGURE_DEPENDS scenes/*.nff scenes/*.png scenes/*.yaml)
install(FILES ${scenes} DESTINATION ${CMAKE_INSTALL_DATADIR}/raytally/scenes)
install(CODE "file(GLOB_RECURSE pages \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DOCDIR}/*.md\"
  \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/raytally/*.md\")")
install(SCRIPT cmake/installed_links.cmake)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The raytally authors <authors@raytally.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/package_files.cmake)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "One ray tracer in C with interchangeable acceleration structures. A harness
counts intersection tests exactly and measures time with intervals. Every hit
is compared, bit for bit, with a loop over all objects, and with Embree.
This package has the program, the library with its headers and a module of
Python, and the guide.")
set(CPACK_DEBIAN_PACKAGE_DEPENDS "fonts-dejavu-core, python3")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "gnuplot-nox, python3-numpy")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "gcc, cmake, make, pkg-config, glmark2-data")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
file(WRITE ${CMAKE_BINARY_DIR}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/triggers)

set(CPACK_SOURCE_GENERATOR TGZ)
set(CPACK_SOURCE_PACKAGE_FILE_NAME raytally-${PROJECT_VERSION})
set(CPACK_SOURCE_INSTALLED_DIRECTORIES "${PROJECT_SOURCE_DIR}/cmake;/cmake") # replaced by package_files.cmake
include(CPack)

add_custom_target(deb COMMAND ${CMAKE_CPACK_COMMAND} WORKING_DIRECTORY ${CMAKE_BINARY_DIR} VERBATIM)
add_dependencies(deb raytally raytally_shared raytally_static)
if(HELP2MAN)
  add_dependencies(deb man)
endif()
