// Converts vectors between the protocol and core.
#ifndef LATVOX_SERVER_WIRE_VECTORS_H_
#define LATVOX_SERVER_WIRE_VECTORS_H_

#include "core/base/vec.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox {

inline Vec3d FromProto(const v1::Vector3& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3i FromProto(const v1::Ijk& ijk) { return {ijk.i(), ijk.j(), ijk.k()}; }

inline void ToProto(const Vec3d& v, v1::Vector3& out) {
  out.set_x(v[0]);
  out.set_y(v[1]);
  out.set_z(v[2]);
}

inline void ToProto(const Vec3i& ijk, v1::Ijk& out) {
  out.set_i(ijk[0]);
  out.set_j(ijk[1]);
  out.set_k(ijk[2]);
}

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_VECTORS_H_
