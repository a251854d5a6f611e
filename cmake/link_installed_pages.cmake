# Run by 'cmake --install' over the pages in `docs`: their links into the sources become links to what is installed beside them, or words.
file(GLOB_RECURSE pages $ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${docs}/*.md)
foreach(page ${pages})
  file(READ ${page} text)
  # Man pages, tests and the pages at the top of the sources.
  string(REGEX REPLACE "\\[([^]]+)\\]\\((\\.\\./)+(man/[a-z-]+\\.[0-9]|tests/[^)]*|[A-Z]+\\.md[^)]*)\\)" "\\1" text "${text}")
  string(REGEX REPLACE "\\]\\(\\.\\./\\.\\./(samples|man)/" "](../\\1/" text "${text}")
  file(WRITE ${page} "${text}")
endforeach()
