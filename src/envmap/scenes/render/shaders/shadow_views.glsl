// Images of lights, in their order.
layout(std430, binding = BUFFER_SHADOW_VIEWS) readonly buffer ShadowViews { ShadowView shadow_views[]; };
