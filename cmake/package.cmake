# 'cpack' in a build of the preset 'deb' makes two packages: envmap_VERSION-1_ARCHITECTURE.deb with program, library,
# headers, pages and completions, and python3-envmap with the Python module.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME envmap)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "convert, prefilter, measure and render environment maps")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL envmap)
set(CPACK_COMPONENTS_IGNORE_GROUPS ON)

# Who stands behind a package is who builds it: as Debian's tools ask, else whom git names in the sources.
if(DEFINED ENV{DEBFULLNAME} AND DEFINED ENV{DEBEMAIL})
  set(builder "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
else()
  foreach(part name email)
    execute_process(COMMAND git -C ${PROJECT_SOURCE_DIR} config user.${part} OUTPUT_VARIABLE ${part}
      OUTPUT_STRIP_TRAILING_WHITESPACE
      ERROR_QUIET)
  endforeach()
  set(builder "${name} <${email}>")
endif()
set(ENVMAP_MAINTAINER "${builder}" CACHE STRING
  "Name and address in the .deb (default: DEBFULLNAME <DEBEMAIL>, else git's)")
set(CPACK_PACKAGE_CONTACT ${ENVMAP_MAINTAINER})

set(about
"envmap works on HDR images of the light that arrives from all directions
around a point: it converts between latlong, cube, mirror-ball, paraboloid,
angular and octahedral maps, prefilters them for lighting, measures and
compares them, and draws them from scenes. On one release of Debian, the same
command gives the same bytes on every machine.
.
")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_ENVMAP_PACKAGE_NAME envmap)
set(CPACK_DEBIAN_ENVMAP_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_ENVMAP_DESCRIPTION "${about}The package holds the program, its C++20 library with headers, manual pages
and completions for bash, zsh and fish.")
# The trigger of policy 8.1.1, and what packages built on the library depend on.
configure_file(${PROJECT_SOURCE_DIR}/packaging/shlibs.in ${PROJECT_BINARY_DIR}/shlibs @ONLY)
set(CPACK_DEBIAN_ENVMAP_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/shlibs ${PROJECT_SOURCE_DIR}/packaging/triggers)
# Opened at run time: what draws, and what writes names into pictures. Headers show GLM.
set(CPACK_DEBIAN_ENVMAP_PACKAGE_RECOMMENDS "libosmesa6 | libgl1-mesa-dri, libegl1, libgl1-mesa-dri, fonts-dejavu-core")
set(CPACK_DEBIAN_ENVMAP_PACKAGE_SUGGESTS "libglm-dev, ninja-build, cmake, python3-envmap")

if(ENVMAP_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  math(EXPR next "${ENVMAP_PYTHON_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-envmap)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  # A module is of one version of Python. The other package holds what reads the formats that are opened at run time.
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${ENVMAP_PYTHON_MINOR}~), python3 (<< 3.${next}), python3-numpy, \
envmap (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "libosmesa6 | libgl1-mesa-dri, libegl1, libgl1-mesa-dri")
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "${about}The package holds the Python module, on numpy arrays.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/python/postinst
    ${PROJECT_SOURCE_DIR}/packaging/python/prerm)
endif()

set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/packaging/finish_deb.cmake)
set(CPACK_ENVMAP_SOURCE ${PROJECT_SOURCE_DIR})
include(CPack)
