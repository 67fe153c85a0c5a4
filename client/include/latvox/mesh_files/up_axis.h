// The axis of a mesh file that points up.
#ifndef LATVOX_LATVOX_MESH_FILES_UP_AXIS_H_
#define LATVOX_LATVOX_MESH_FILES_UP_AXIS_H_

namespace latvox::client {

// It becomes z, by an exact quarter turn.
enum class UpAxis {
  kX,  // turns about y: (x, y, z) goes to (-z, y, x)
  kY,  // turns about x: (x, y, z) goes to (x, -z, y)
  kZ,  // stays as it is
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_MESH_FILES_UP_AXIS_H_
