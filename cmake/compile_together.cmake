# compile_together(TARGET NAME FILES...): adds files to a target that are compiled as one. What they include is read
# once.
function(compile_together target name)
  target_sources(${target} PRIVATE ${ARGN})
  set_source_files_properties(${ARGN} PROPERTIES UNITY_GROUP ${name})
endfunction()
# Options of code that touches no texel: it compiles a quarter faster, and runs as fast. A precompiled header is for
# targets of one optimisation: GCC 13 refuses others, and GCC 12 may crash.
set(cold $<$<CONFIG:Release>:-O1>)
