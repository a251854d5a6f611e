# cmake -DOUTPUT=x.cpp -DFUNCTION=shader_source -DHEADER=envmap/scenes/render/shaders.h -DNAMESPACE=envmap
#   -DFILES=a.glsl;b.glsl -P embed.cmake
# The text of the files as C++, by their names.
set(text "#include \"${HEADER}\"\n\n")
string(APPEND text "namespace ${NAMESPACE} {\n\nstd::string_view ${FUNCTION}(std::string_view name) {\n")
foreach(file ${FILES})
  get_filename_component(name ${file} NAME)
  file(READ ${file} source)
  string(APPEND text "  if (name == \"${name}\") return R\"embedded(${source})embedded\";\n")
endforeach()
string(APPEND text "  return {};\n}\n\n}  // namespace ${NAMESPACE}\n")
file(WRITE ${OUTPUT} "${text}")
