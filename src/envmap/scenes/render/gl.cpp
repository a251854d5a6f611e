#include "envmap/scenes/render/gl.h"

#include <fmt/format.h>

#include <new>
#include <stdexcept>

#include "envmap/base/words.h"
#include "envmap/scenes/render/shaders.h"

namespace envmap::gl {
namespace {

using Shader = Object<glDeleteShader>;

GLuint named(auto create, auto... target) {
  GLuint name = 0;
  create(target..., 1, &name);
  return name;
}

std::string log_of(auto get, GLuint name) {
  std::string message(4096, '\0');
  GLsizei length = 0;
  get(name, static_cast<GLsizei>(message.size()), &length, message.data());
  message.resize(std::size_t(length));
  return message;
}

// Mesa takes an undefined name in a condition for 0.
void check_conditions(const std::string& source, const Definitions& definitions) {
  const auto ends_names = [](unsigned char c) { return std::isalnum(c) == 0 && c != '_'; };
  for (const std::string& line : split(source, '\n')) {
    if (!line.starts_with('#')) continue;
    std::string separated = line;
    std::ranges::replace_if(separated, ends_names, ' ');
    std::vector<std::string> names = split(separated, ' ');
    std::erase_if(names, [](const std::string& name) { return name.empty() || std::isdigit(name[0]) != 0; });
    if (names.empty()) continue;
    const std::string directive = names.front();
    if (directive == "ifdef" || directive == "ifndef") throw std::runtime_error(line + ": use #if, which is checked");
    if (directive != "if" && directive != "elif") continue;
    for (const std::string& name : std::span(names).subspan(1))
      if (!definitions.contains(name)) throw std::runtime_error(fmt::format("{}: {} is not defined", line, name));
  }
}

Shader compile(const Stage& stage, const Definitions& definitions) {
  std::string text = "#version 450 core\n", names;
  for (const auto& [name, value] : definitions) text += fmt::format("#define {} {}\n", name, value);
  for (const std::string& file : stage.files) {
    const std::string source(shader_source(file));
    if (source.empty()) throw std::runtime_error(file + ": there is no such shader");
    check_conditions(source, definitions);
    // Line numbers of messages are those of the file.
    text += "#line 1\n" + source;
    names += (names.empty() ? "" : " ") + file;
  }
  Shader shader(glCreateShader(stage.kind));
  const char* lines = text.c_str();
  glShaderSource(shader, 1, &lines, nullptr);
  glCompileShader(shader);
  GLint compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  throw std::runtime_error(fmt::format("{}: {}", names, log_of(glGetShaderInfoLog, shader)));
}

}  // namespace

Buffer make_buffer(const void* data, std::size_t bytes, GLbitfield flags) {
  Buffer buffer(named(glCreateBuffers));
  if (bytes == 0)
    glNamedBufferStorage(buffer, 16, nullptr, flags);
  else
    glNamedBufferStorage(buffer, static_cast<GLsizeiptr>(bytes), data, flags);
  return buffer;
}

void interpolate(const Texture& texture) {
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

Texture make_texture(GLenum target) { return Texture(named(glCreateTextures, target)); }
VertexArray make_vertex_array() { return VertexArray(named(glCreateVertexArrays)); }
Framebuffer make_framebuffer() { return Framebuffer(named(glCreateFramebuffers)); }
Query make_query(GLenum target) { return Query(named(glCreateQueries, target)); }
Renderbuffer make_renderbuffer(GLenum format, int width, int height) {
  Renderbuffer made(named(glCreateRenderbuffers));
  glNamedRenderbufferStorage(made, format, width, height);
  return made;
}

Program make_program(const std::vector<Stage>& stages, const Definitions& definitions) {
  Program program(glCreateProgram());
  for (const Stage& stage : stages) glAttachShader(program, compile(stage, definitions));
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  throw std::runtime_error(log_of(glGetProgramInfoLog, program));
}

void set(const Program& p, const char* name, int value) { glProgramUniform1i(p, glGetUniformLocation(p, name), value); }
void set(const Program& p, const char* name, float value) {
  glProgramUniform1f(p, glGetUniformLocation(p, name), value);
}
void set(const Program& p, const char* name, std::span<const float, 2> value) {
  glProgramUniform2fv(p, glGetUniformLocation(p, name), 1, value.data());
}
void set(const Program& p, const char* name, const glm::vec3& value) {
  glProgramUniform3fv(p, glGetUniformLocation(p, name), 1, &value.x);
}
void set(const Program& p, const char* name, const glm::mat<3, 3, double, glm::highp>& value) {
  const glm::mat<3, 3, float, glm::highp> rounded(value);
  glProgramUniformMatrix3fv(p, glGetUniformLocation(p, name), 1, GL_FALSE, &rounded[0][0]);
}

void set(const Program& p, const char* name, const glm::vec4& value) {
  glProgramUniform4fv(p, glGetUniformLocation(p, name), 1, &value.x);
}
void set(const Program& p, const char* name, const glm::mat4& value) {
  glProgramUniformMatrix4fv(p, glGetUniformLocation(p, name), 1, GL_FALSE, &value[0][0]);
}

void check(const char* doing) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  if (error == GL_OUT_OF_MEMORY) throw std::bad_alloc();
  throw std::runtime_error(fmt::format("{}: OpenGL says error 0x{:x}", doing, error));
}

}  // namespace envmap::gl
