// Blended surfaces: layer by layer onto what is behind them.
#include "envmap/scenes/render/renderer.h"

namespace envmap {

// From the furthest layer to the nearest: of each texel there is the furthest surface that is nearer than the last.
void Renderer::blend(const Viewpoint& from, const FrameState& shot, DrawMethod method, int face, int sample) {
  const gl::Query query = gl::make_query(GL_ANY_SAMPLES_PASSED);
  const gl::Texture* behind = &canvas_->depth;
  bool first = true;
  for (std::size_t turn = 0;; turn = 1 - turn, first = false) {
    glBindTextureUnit(unit_behind, *behind);
    glBeginQuery(GL_ANY_SAMPLES_PASSED, query);
    find_surfaces(from, shot, method, {face, sample, layers_->seen[turn], true, first && sample == 0});
    glEndQuery(GL_ANY_SAMPLES_PASSED);
    GLuint any = 0;
    glGetQueryObjectuiv(query, GL_QUERY_RESULT, &any);
    if (any == 0) return;
    glBindFramebuffer(GL_FRAMEBUFFER, layers_->lit[turn]);
    begin_shading();
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_CONSTANT_ALPHA, GL_ONE);
    glBlendColor(0, 0, 0, shot.look.images ? least_nearness : 0);
    for (std::size_t k = 0; k < gpu_.groups().size(); ++k) shade_group(from, shot, k, true);
    behind = &layers_->depth[turn];
  }
}

void Renderer::add_sample(const MapTexture& to, int face, int sample, int samples) {
  const gl::Program& adding = programs_->adding();
  bind_map(to, face, sample);
  glDisable(GL_STENCIL_TEST);
  glDisable(GL_DEPTH_TEST);
  glBindTextureUnit(unit_behind, layers_->sample);
  gl::set(adding, "weight", float(1.0 / samples));
  glUseProgram(adding);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace envmap
