# 'cpack' in a build of the preset 'deb' makes envmap_VERSION-1_ARCHITECTURE.deb: program, library, headers, pages, completions.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME envmap)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(ENVMAP_MAINTAINER "The envmap authors <envmap@example.org>" CACHE STRING "Name and address in the .deb: yours, where you publish it")
set(CPACK_PACKAGE_CONTACT ${ENVMAP_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "convert, prefilter, measure and render environment maps")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
"envmap works on HDR images of the light that arrives from all directions
around a point: it converts between latlong, cube, mirror-ball, paraboloid,
angular and octahedral maps, prefilters them for lighting, measures and
compares them, and draws them from scenes. The same command gives the same
bytes on every machine.
.
The package holds the program, its C++20 library with headers, manual pages
and completions for bash, zsh and fish.")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# The trigger of policy 8.1.1, and what packages built on the library depend on.
configure_file(${PROJECT_SOURCE_DIR}/packaging/shlibs.in ${PROJECT_BINARY_DIR}/shlibs @ONLY)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/shlibs ${PROJECT_SOURCE_DIR}/packaging/triggers)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
# Opened at run time: what draws, and what writes names into pictures. Headers show GLM.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libosmesa6, libegl1, fonts-dejavu-core")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libglm-dev, ninja-build, cmake")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/packaging/finish_deb.cmake)
set(CPACK_ENVMAP_SOURCE ${PROJECT_SOURCE_DIR})
include(CPack)
