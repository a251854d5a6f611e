# What Debian wants of packages beyond 'cmake --install': run by CPack over the trees before they are packed.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# Copyright, and the changes under the names that Debian's tools look for.
function(add_documents tree package)
  set(doc ${tree}/usr/share/doc/${package})
  file(READ ${CPACK_ENVMAP_SOURCE}/LICENSE license)
  string(REGEX REPLACE "\n\n+" "\n.\n" license "${license}")
  string(REGEX REPLACE "\n" "\n " license " ${license}")
  string(STRIP "${license}" license)
  file(WRITE ${doc}/copyright "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: envmap

Files: *
Copyright: the envmap authors
License: envmap
 ${license}
")
  configure_file(${CPACK_ENVMAP_SOURCE}/CHANGELOG.md ${doc}/changelog COPYONLY)
  configure_file(${CPACK_ENVMAP_SOURCE}/packaging/changelog.Debian.in ${doc}/changelog.Debian @ONLY)
  # No time and no name in what is compressed: the same bytes every time.
  run(gzip -9nf ${doc}/changelog ${doc}/changelog.Debian)
  file(CHMOD_RECURSE ${tree}/usr/share FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ
    DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
endfunction()

set(tree ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/envmap)
file(REMOVE ${tree}/usr/share/doc/envmap/LICENSE)
# zsh of Debian looks here for what packages bring.
file(MAKE_DIRECTORY ${tree}/usr/share/zsh/vendor-completions)
file(RENAME ${tree}/usr/share/zsh/site-functions/_envmap ${tree}/usr/share/zsh/vendor-completions/_envmap)
file(REMOVE_RECURSE ${tree}/usr/share/zsh/site-functions)
file(GLOB_RECURSE pages ${tree}/usr/share/man/*)
run(gzip -9nf ${pages})
file(GLOB_RECURSE archives ${tree}/usr/lib/*.a)
run(strip --strip-debug --remove-section=.comment --remove-section=.note --enable-deterministic-archives ${archives})
add_documents(${tree} envmap)
if(EXISTS ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/python)
  add_documents(${CPACK_TEMPORARY_INSTALL_DIRECTORY}/python python3-envmap)
endif()
