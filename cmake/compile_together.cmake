# compile_together(TARGET NAME FILES...): adds files to a target that are compiled as one. What they include is read
# once.
function(compile_together target name)
  target_sources(${target} PRIVATE ${ARGN})
  set_source_files_properties(${ARGN} PROPERTIES UNITY_GROUP ${name})
endfunction()
# Options of code that touches no texel: it compiles a quarter faster, and runs as fast. Not for a target whose
# precompiled header others reuse with -O3: GCC 12 fails there.
set(cold $<$<CONFIG:Release>:-O1>)
