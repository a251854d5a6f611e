# What Debian wants of a package beyond 'cmake --install': run by CPack over the tree before it is packed.
cmake_minimum_required(VERSION 3.25)
set(tree ${CPACK_TEMPORARY_INSTALL_DIRECTORY})
set(doc ${tree}/usr/share/doc/envmap)

function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

# Copyright, and the changes under the names that Debian's tools look for.
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
file(REMOVE ${doc}/LICENSE)
configure_file(${CPACK_ENVMAP_SOURCE}/CHANGELOG.md ${doc}/changelog COPYONLY)
configure_file(${CPACK_ENVMAP_SOURCE}/packaging/changelog.Debian.in ${doc}/changelog.Debian @ONLY)
# zsh of Debian looks here for what packages bring.
file(MAKE_DIRECTORY ${tree}/usr/share/zsh/vendor-completions)
file(RENAME ${tree}/usr/share/zsh/site-functions/_envmap ${tree}/usr/share/zsh/vendor-completions/_envmap)
file(REMOVE_RECURSE ${tree}/usr/share/zsh/site-functions)

# No time and no name in what is compressed: the same bytes every time.
file(GLOB_RECURSE pages ${tree}/usr/share/man/*)
run(gzip -9nf ${pages} ${doc}/changelog ${doc}/changelog.Debian)
file(GLOB_RECURSE archives ${tree}/usr/lib/*.a)
run(strip --strip-debug --remove-section=.comment --remove-section=.note --enable-deterministic-archives ${archives})
file(CHMOD_RECURSE ${tree}/usr/share FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ
  DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
