# What 'cmake --install' puts where: the program with its pages and completions, and the library for others to build on.
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME envmap)

# The program.
if(ENVMAP_SCENES)
  install(TARGETS envmap_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(TARGET water)
  install(TARGETS water RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(ENVMAP_OPENIMAGEIO)
  install(TARGETS envmap_formats LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/envmap)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
foreach(page library python systems)
  install(FILES ${PROJECT_SOURCE_DIR}/docs/${page}.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
endforeach()
foreach(folder how-to reference tutorial explanation)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/${folder} DESTINATION ${CMAKE_INSTALL_DOCDIR})
endforeach()
# What these pages show and link to.
file(GLOB pictures ${PROJECT_SOURCE_DIR}/samples/scenes/*.jpg ${PROJECT_SOURCE_DIR}/samples/scenes/*.webp)
install(FILES ${pictures} DESTINATION ${CMAKE_INSTALL_DOCDIR}/samples/scenes)
install(FILES ${PROJECT_SOURCE_DIR}/samples/gallery.jpg DESTINATION ${CMAKE_INSTALL_DOCDIR}/samples)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/samples/build DESTINATION ${CMAKE_INSTALL_DOCDIR}/samples)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/man/figures DESTINATION ${CMAKE_INSTALL_DOCDIR}/man)
install(CODE "set(docs \"${CMAKE_INSTALL_DOCDIR}\")")
install(SCRIPT ${CMAKE_CURRENT_LIST_DIR}/link_installed_pages.cmake)
# What the examples read: 'envmap manual --samples' prints the folder.
set(samples ${CMAKE_INSTALL_DATADIR}/envmap/samples)
install(FILES ${PROJECT_SOURCE_DIR}/samples/sample.hdr ${PROJECT_SOURCE_DIR}/samples/inputs.sh DESTINATION ${samples})
install(FILES ${PROJECT_SOURCE_DIR}/samples/scenes/make.py ${PROJECT_SOURCE_DIR}/samples/scenes/gltf.py
  DESTINATION ${samples}/scenes)
foreach(section 1 3 7)
  file(GLOB pages CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/man/*.${section})
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section})
endforeach()
# Completions, where each shell looks for them by itself; the program knows its options.
if(ENVMAP_SCENES)
  set(bash_place bash-completion/completions/envmap)
  set(zsh_place zsh/site-functions/_envmap)
  set(fish_place fish/vendor_completions.d/envmap.fish)
  set(scripts)
  foreach(shell bash zsh fish)
    set(script ${PROJECT_BINARY_DIR}/completions/${${shell}_place})
    cmake_path(GET script PARENT_PATH folder)
    file(MAKE_DIRECTORY ${folder})
    add_custom_command(OUTPUT ${script} COMMAND envmap_program completion ${shell} > ${script} DEPENDS envmap_program
      VERBATIM)
    list(APPEND scripts ${script})
  endforeach()
  add_custom_target(completions ALL DEPENDS ${scripts})
  install(DIRECTORY ${PROJECT_BINARY_DIR}/completions/ DESTINATION ${CMAKE_INSTALL_DATADIR})
endif()

# The library: shared as envmap::envmap, static as envmap::static; and envmap::scenes, which draws.
install(TARGETS envmap_shared EXPORT shared LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(ENVMAP_SCENES)
  install(TARGETS envmap_scenes_shared EXPORT scenes LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
endif()
install(TARGETS envmap EXPORT static ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
# Not in a folder of the processor, as lib/x86_64-linux-gnu, which projects without a language do not search.
set(package lib/cmake/envmap)
install(EXPORT shared NAMESPACE envmap:: FILE envmapTargets.cmake DESTINATION ${package})
if(ENVMAP_SCENES)
  install(EXPORT scenes NAMESPACE envmap:: FILE envmapScenesTargets.cmake DESTINATION ${package})
endif()
install(EXPORT static NAMESPACE envmap:: FILE envmapStaticTargets.cmake DESTINATION ${package})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/envmapConfig.cmake.in ${PROJECT_BINARY_DIR}/envmapConfig.cmake
  INSTALL_DESTINATION ${package} PATH_VARS CMAKE_INSTALL_BINDIR NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/envmapConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/envmapConfig.cmake ${CMAKE_CURRENT_LIST_DIR}/envmapMaps.cmake
  ${PROJECT_BINARY_DIR}/envmapConfigVersion.cmake DESTINATION ${package})
# Relative to its own place, so that an installed tree can be moved.
file(RELATIVE_PATH prefix_from_pc ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
# Not Requires.private, which would ask for their headers where the shared library alone is used.
list(JOIN OpenEXR_LDFLAGS " " private_libraries)
foreach(flags OpenColorIO_LDFLAGS Png_LDFLAGS Jpeg_LDFLAGS Tiff_LDFLAGS Lcms_LDFLAGS Zlib_LDFLAGS Zstd_LDFLAGS
    Highway_LDFLAGS)
  list(JOIN ${flags} " " flags)
  string(APPEND private_libraries " ${flags}")
endforeach()
configure_file(${CMAKE_CURRENT_LIST_DIR}/envmap.pc.in ${PROJECT_BINARY_DIR}/envmap.pc @ONLY)
configure_file(${CMAKE_CURRENT_LIST_DIR}/envmap-scenes.pc.in ${PROJECT_BINARY_DIR}/envmap-scenes.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/envmap.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
if(ENVMAP_SCENES)
  install(FILES ${PROJECT_BINARY_DIR}/envmap-scenes.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()

# The Python module, of a package of its own: 'cmake --install' leaves it out, 'pip install .' knows its place.
if(ENVMAP_PYTHON)
  install(TARGETS envmap_python LIBRARY DESTINATION lib/python3/dist-packages/envmap COMPONENT python EXCLUDE_FROM_ALL)
  install(DIRECTORY src/python/envmap DESTINATION lib/python3/dist-packages COMPONENT python EXCLUDE_FROM_ALL
    FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN "py.typed")
endif()
