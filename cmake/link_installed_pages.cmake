# Run by 'cmake --install' over the pages in `docs`: links into the sources become links to what is installed, or words.
file(GLOB_RECURSE pages $ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${docs}/*.md)
# Man pages, tests and the pages at the top of the sources.
set(only_in_sources "man/[a-z-]+\\.[0-9]|tests/[^)]*|[A-Z]+\\.md[^)]*")
foreach(page ${pages})
  file(READ ${page} text)
  string(REGEX REPLACE "\\[([^]]+)\\]\\((\\.\\./)+(${only_in_sources})\\)" "\\1" text "${text}")
  string(REGEX REPLACE "\\]\\(\\.\\./\\.\\./(samples|man)/" "](../\\1/" text "${text}")
  file(WRITE ${page} "${text}")
endforeach()
