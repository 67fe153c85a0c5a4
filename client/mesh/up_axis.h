#ifndef LATVOX_CLIENT_MESH_UP_AXIS_H_
#define LATVOX_CLIENT_MESH_UP_AXIS_H_

namespace latvox::client {

// The axis that points up.
enum class UpAxis { kX, kY, kZ };

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_UP_AXIS_H_
