# SPDX-License-Identifier: Apache-2.0
# libraytally.so and libraytally.a, of all libraries that are declared so far, and what is installed with them: headers,
# raytally.pc, and a CMake package, which the build folder is, too. The number of the shared library is that of the binary
# interface.
file(STRINGS include/raytally/raytally.h abi REGEX "^#define RAYTALLY_ABI_VERSION [0-9]+$")
string(REGEX REPLACE ".* " "" abi "${abi}")
get_property(libraries DIRECTORY PROPERTY raytally_libraries)
get_property(components DIRECTORY PROPERTY raytally_components)
list(REMOVE_DUPLICATES components)
list(TRANSFORM libraries REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE objects)

add_library(raytally_shared SHARED ${objects})
set_target_properties(raytally_shared PROPERTIES OUTPUT_NAME raytally EXPORT_NAME raytally SOVERSION ${abi} LINKER_LANGUAGE C)
target_link_options(raytally_shared PRIVATE LINKER:--version-script=${CMAKE_SOURCE_DIR}/cmake/library.map)
set_property(TARGET raytally_shared PROPERTY LINK_DEPENDS ${CMAKE_SOURCE_DIR}/cmake/library.map)
target_link_libraries(raytally_shared PRIVATE "$<BUILD_INTERFACE:${components}>")

# In one object, of which a linker sees what is exported alone.
set(whole ${CMAKE_BINARY_DIR}/libraytally.o)
add_custom_command(OUTPUT ${whole} DEPENDS ${objects} COMMAND_EXPAND_LISTS VERBATIM
  COMMAND ${CMAKE_LINKER} -r -o ${whole} ${objects}
  COMMAND ${CMAKE_OBJCOPY} --wildcard --keep-global-symbol=raytally_* ${whole})
add_library(raytally_static STATIC ${whole})
set_source_files_properties(${whole} PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
set_target_properties(raytally_static PROPERTIES OUTPUT_NAME raytally EXPORT_NAME static LINKER_LANGUAGE C)
target_link_libraries(raytally_static PRIVATE ${components})

foreach(library shared static)
  target_include_directories(raytally_${library} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/include>)
  install(TARGETS raytally_${library} EXPORT raytally-${library})
  install(EXPORT raytally-${library} NAMESPACE raytally:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/raytally)
  export(EXPORT raytally-${library} NAMESPACE raytally:: FILE ${CMAKE_BINARY_DIR}/raytally-${library}.cmake)
endforeach()

# Of a plugin, which is linked with nothing.
add_library(raytally_headers INTERFACE)
set_target_properties(raytally_headers PROPERTIES EXPORT_NAME headers)
target_include_directories(raytally_headers INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
  $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/include>)
install(TARGETS raytally_headers EXPORT raytally-headers)
install(EXPORT raytally-headers NAMESPACE raytally:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/raytally)
export(EXPORT raytally-headers NAMESPACE raytally:: FILE ${CMAKE_BINARY_DIR}/raytally-headers.cmake)
install(DIRECTORY include/raytally DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")

# Where Python of Debian looks below /usr; below other prefixes PYTHONPATH names it.
set(RT_PYTHON_DIR lib/python3/dist-packages CACHE STRING "Where the Python module is installed, below the prefix")
install(FILES python/raytally.py DESTINATION ${RT_PYTHON_DIR})

# What builds against it.
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} USE_SOURCE_PERMISSIONS)

# Both find what is installed from where they lie themselves, so that all of it may be moved.
include(CMakePackageConfigHelpers)
configure_package_config_file(cmake/raytally-config.cmake.in raytally-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/raytally)
write_basic_package_version_file(raytally-config-version.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/raytally-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/raytally-config-version.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/raytally)
# What libraytally.a needs is named by its flags: by Requires.private, programs that link the shared library would need it too.
pkg_check_modules(STATIC gmp jansson libpng libxxhash yaml-0.1)
set(private ${STATIC_STATIC_LDFLAGS} -lm -pthread)
list(FILTER private EXCLUDE REGEX "^-L/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}$") # where linkers look anyway
if(RT_WITH_EMBREE)
  list(PREPEND private -lembree${embree_VERSION_MAJOR})
endif()
list(JOIN private " " private)
file(RELATIVE_PATH up ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
configure_file(cmake/raytally.pc.in raytally.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/raytally.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
