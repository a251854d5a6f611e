/// @file
/// Embree 3 and 4: what they name or call differently. Nothing else depends on Embree's version.
#pragma once

#if ENVMAP_EMBREE == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

namespace envmap::embree {

#if ENVMAP_EMBREE == 3

using Context = RTCIntersectContext;

inline void prepare(Context& context) { rtcInitIntersectContext(&context); }
inline void intersect(RTCScene scene, Context& context, RTCRayHit& hit) { rtcIntersect1(scene, &context, &hit); }
inline void occlude(RTCScene scene, Context& context, RTCRay& ray) { rtcOccluded1(scene, &context, &ray); }

#else

using Context = RTCRayQueryContext;

inline void prepare(Context& context) { rtcInitRayQueryContext(&context); }
inline void intersect(RTCScene scene, Context& context, RTCRayHit& hit) {
  RTCIntersectArguments how;
  rtcInitIntersectArguments(&how);
  how.context = &context;
  rtcIntersect1(scene, &hit, &how);
}
inline void occlude(RTCScene scene, Context& context, RTCRay& ray) {
  RTCOccludedArguments how;
  rtcInitOccludedArguments(&how);
  how.context = &context;
  rtcOccluded1(scene, &ray, &how);
}

#endif

}  // namespace envmap::embree
