# Maps as part of a build: made again when anything that they were made from changes, and only then.
#
#   envmap_add_map(TARGET SOURCE FILE OUTPUT FILE [COMMAND NAME] [OPTIONS ...] [DEPENDS ...])
#     runs 'envmap NAME SOURCE OUTPUT OPTIONS' (convert, where nothing is said; mipmap, prefilter, render ...).
#   envmap_add_maps(TARGET SOURCES FILE... FOR ENGINE... [DESTINATION FOLDER] [OPTIONS ...])
#     runs 'envmap bake' for each source and engine, into FOLDER/ENGINE/NAME OF THE SOURCE WITHOUT ITS EXTENSION.
#
# OUTPUT with {face}, {half}, {eye} or {level} stands for all files that the program writes.
#
# Sources are relative to CMAKE_CURRENT_SOURCE_DIR, outputs and FOLDER to CMAKE_CURRENT_BINARY_DIR. TARGET is made, as
# part of 'all', or more is added to it. What a scene or a config of colours reads comes from the program's --depfile.
# In names of outputs CMake allows neither # nor < nor >, and Ninja reads neither $ nor ' there: the second function
# writes _ for them. A file with $ in its name is seen where it is a source, not where the depfile alone knows it.

# Run as a script: Ninja refuses depfiles that name other outputs than the one it was told of, which is the first.
if(CMAKE_SCRIPT_MODE_FILE)
  file(READ "${ENVMAP_DEPFILE}" text)
  string(REPLACE " " "\\ " program "${ENVMAP_PROGRAM}") # A rule without any file would be dropped.
  string(REGEX REPLACE "^(([^\\ :]|\\\\.)+)( [^\n]*[^\\\\])?: " "\\1: ${program} " text "${text}")
  # CMake 3.25 rewrites depfiles for Ninja and forgets what $ must become; sources are known without them.
  set(dollar "([^ \n\\]|\\\\.)*[$][$]([^ \n\\]|\\\\.)*")
  string(REGEX REPLACE "\n${dollar}:" "" text "${text}")
  string(REGEX REPLACE " ${dollar}" "" text "${text}")
  file(WRITE "${ENVMAP_DEPFILE}" "${text}")
  return()
endif()

# @param outputs the files that CMake looks at. The first is the first that the depfile names. Further arguments: the
# command.
function(_envmap_add_command target outputs sources)
  get_property(count GLOBAL PROPERTY _envmap_maps)
  math(EXPR count "${count} + 1")
  set_property(GLOBAL PROPERTY _envmap_maps ${count})
  list(GET outputs 0 output)
  cmake_path(GET output PARENT_PATH folder)
  set(depfile ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/envmap-${count}.d)
  add_custom_command(OUTPUT ${outputs}
    COMMAND ${CMAKE_COMMAND} -E make_directory "${folder}"
    COMMAND ${ENVMAP_PROGRAM} ${ARGN} --depfile "${depfile}"
    COMMAND ${CMAKE_COMMAND} "-DENVMAP_DEPFILE=${depfile}" "-DENVMAP_PROGRAM=${ENVMAP_PROGRAM}" -P
      "${CMAKE_CURRENT_FUNCTION_LIST_FILE}"
    DEPENDS ${sources} ${ENVMAP_PROGRAM}
    DEPFILE ${depfile}
    COMMENT "envmap ${ARGV3}: map ${count} of ${target}"
    VERBATIM)
  add_custom_target(${target}-map-${count} DEPENDS ${outputs})
  if(NOT TARGET ${target})
    add_custom_target(${target} ALL)
  endif()
  add_dependencies(${target} ${target}-map-${count})
endfunction()

# Replaces a name with MARK by one name for each of the further arguments.
function(_envmap_expand names mark)
  foreach(name IN LISTS ${names})
    string(FIND "${name}" "${mark}" at)
    if(at EQUAL -1)
      list(APPEND all "${name}")
      continue()
    endif()
    foreach(word IN LISTS ARGN)
      string(REPLACE "${mark}" "${word}" one "${name}")
      list(APPEND all "${one}")
    endforeach()
  endforeach()
  set(${names} "${all}" PARENT_SCOPE)
endfunction()

# The names of the maps that 'envmap bake' writes for an engine, in the order of its depfile.
function(_envmap_maps_for engine result)
  get_property(report GLOBAL PROPERTY _envmap_engines)
  if(NOT report)
    execute_process(COMMAND ${ENVMAP_PROGRAM} bake --list --json OUTPUT_VARIABLE report COMMAND_ERROR_IS_FATAL ANY)
    set_property(GLOBAL PROPERTY _envmap_engines "${report}")
  endif()
  string(JSON count LENGTH "${report}" engines)
  foreach(k RANGE 1 ${count})
    math(EXPR k "${k} - 1")
    string(JSON name GET "${report}" engines ${k} name)
    list(APPEND names ${name})
    if(name STREQUAL engine)
      string(JSON maps GET "${report}" engines ${k} maps)
      string(REGEX MATCHALL "[^][\", \n]+" maps "${maps}")
      set(${result} ${maps} PARENT_SCOPE)
      return()
    endif()
  endforeach()
  list(JOIN names ", " names)
  message(FATAL_ERROR "envmap_add_maps: FOR ${engine}: no such engine: choose one of ${names}")
endfunction()

function(envmap_add_map target)
  cmake_parse_arguments(PARSE_ARGV 1 map "" "SOURCE;OUTPUT;COMMAND" "OPTIONS;DEPENDS")
  if(map_UNPARSED_ARGUMENTS OR NOT map_SOURCE OR NOT map_OUTPUT)
    message(FATAL_ERROR "envmap_add_map(${target}): SOURCE FILE OUTPUT FILE [COMMAND NAME] [OPTIONS ...] [DEPENDS ...]")
  endif()
  if(NOT map_COMMAND)
    set(map_COMMAND convert)
  endif()
  cmake_path(ABSOLUTE_PATH map_SOURCE BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
  cmake_path(ABSOLUTE_PATH map_OUTPUT BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  set(outputs "${map_OUTPUT}")
  _envmap_expand(outputs "{face}" px nx py ny pz nz)
  _envmap_expand(outputs "{half}" front back)
  _envmap_expand(outputs "{eye}" left right both)
  _envmap_expand(outputs "{level}" 0) # How many follow is known when they are made.
  _envmap_add_command(${target} "${outputs}" "${map_SOURCE};${map_DEPENDS}" ${map_COMMAND} "${map_SOURCE}"
    "${map_OUTPUT}"
    ${map_OPTIONS})
endfunction()

function(envmap_add_maps target)
  cmake_parse_arguments(PARSE_ARGV 1 maps "" "DESTINATION" "SOURCES;FOR;OPTIONS")
  if(maps_UNPARSED_ARGUMENTS OR NOT maps_SOURCES OR NOT maps_FOR)
    message(FATAL_ERROR "envmap_add_maps(${target}): SOURCES FILE... FOR ENGINE... [DESTINATION FOLDER] [OPTIONS ...]")
  endif()
  if(NOT maps_DESTINATION)
    set(maps_DESTINATION ${target})
  endif()
  cmake_path(ABSOLUTE_PATH maps_DESTINATION BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  foreach(source IN LISTS maps_SOURCES)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    cmake_path(GET source STEM LAST_ONLY name)
    string(REGEX REPLACE "[#<>$']" "_" name "${name}")
    foreach(engine IN LISTS maps_FOR)
      set(folder "${maps_DESTINATION}/${engine}/${name}")
      _envmap_maps_for(${engine} files)
      list(TRANSFORM files PREPEND "${folder}/")
      _envmap_add_command(${target} "${files}" "${source}" bake "${source}" "${folder}" --for ${engine} ${maps_OPTIONS})
    endforeach()
  endforeach()
endfunction()
