/// @file
/// OpenGL's functions, and its objects as values that delete themselves. They must go before their context.
#pragma once

#include <glad/gl.h>

#include <glm/glm.hpp>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace envmap::gl {

/// The name of an object that is deleted with the value. 0: none.
/// @param Delete takes a name, or a number of names.
template <auto& Delete>
class Object {
 public:
  Object() = default;
  explicit Object(GLuint name) : name_(name) {}
  Object(Object&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Object& operator=(Object other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~Object() {
    if (name_ == 0) return;
    if constexpr (std::is_invocable_v<decltype(Delete), GLuint>)
      Delete(name_);
    else
      Delete(1, &name_);
  }
  operator GLuint() const { return name_; }  // NOLINT: it is what GL's functions take

 private:
  GLuint name_ = 0;
};

using Buffer = Object<glDeleteBuffers>;
using Texture = Object<glDeleteTextures>;
using Renderbuffer = Object<glDeleteRenderbuffers>;
using Framebuffer = Object<glDeleteFramebuffers>;
using VertexArray = Object<glDeleteVertexArrays>;
using Query = Object<glDeleteQueries>;
using Program = Object<glDeleteProgram>;

/// A buffer that holds this and does not grow. Empty ones hold 16 bytes, since GL binds none of 0.
Buffer make_buffer(const void* data, std::size_t bytes, GLbitfield flags = 0);
template <class T>
Buffer make_buffer(const std::vector<T>& all, GLbitfield flags = 0) {
  return make_buffer(all.data(), all.size() * sizeof(T), flags);
}

Texture make_texture(GLenum target);
/// Linear filtering within the level, edges clamped.
void interpolate(const Texture& texture);
VertexArray make_vertex_array();
Framebuffer make_framebuffer();
/// Of a target such as GL_ANY_SAMPLES_PASSED.
Query make_query(GLenum target);
Renderbuffer make_renderbuffer(GLenum format, int width, int height);

/// Macros and what they stand for.
using Definitions = std::map<std::string, std::string>;

/// One stage of a program: files of shaders/, put one behind the other under `#version` and the definitions.
struct Stage {
  GLenum kind;
  std::vector<std::string> files;
};
/// A condition (#if) on a name that nobody defines is an error, so that nothing is left out of a program without a
/// word; #ifdef, which cannot be checked, is one, too.
/// @throws std::runtime_error with GL's message.
Program make_program(const std::vector<Stage>& stages, const Definitions& definitions);

/// Sets a uniform of the program, if it has it.
void set(const Program& program, const char* name, int value);
void set(const Program& program, const char* name, float value);
void set(const Program& program, const char* name, std::span<const float, 2> value);
void set(const Program& program, const char* name, const glm::vec3& value);
void set(const Program& program, const char* name, const glm::mat<3, 3, double, glm::highp>& value);
void set(const Program& program, const char* name, const glm::vec4& value);
void set(const Program& program, const char* name, const glm::mat4& value);

/// @throws std::bad_alloc where GL ran out of memory, std::runtime_error on any other error since the last call.
void check(const char* doing);

}  // namespace envmap::gl
