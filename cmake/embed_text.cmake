# embed_text(OUTPUT FUNCTION HEADER NAMESPACE FILES...): a C++ file with FUNCTION of HEADER, which holds the text of the
# files by their names.
function(embed_text output function header namespace)
  set(script ${PROJECT_SOURCE_DIR}/cmake/embed.cmake)
  get_filename_component(name ${output} NAME_WE)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} "-DOUTPUT=${output}" "-DFILES=${ARGN}" -DFUNCTION=${function} -DHEADER=${header}
            -DNAMESPACE=${namespace} -P ${script}
    DEPENDS ${ARGN} ${script}
    COMMENT "Text of ${name}"
    VERBATIM)
endfunction()
