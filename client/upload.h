// The client's side of the streams that carry a mesh. Internal to the SDK.
#ifndef LATVOX_CLIENT_UPLOAD_H_
#define LATVOX_CLIENT_UPLOAD_H_

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

namespace latvox::client {

inline constexpr size_t kPieceBytes = size_t{1} << 20;

// Sends `first`, which has the spec, then the mesh in pieces, and half-closes. Returns the bytes of messages sent. A
// failed write means that the call is over; why, Finish tells.
template <class Request, class Stream>
uint64_t Upload(const Request& first, std::string_view mesh, Stream& stream) {
  if (!stream.Write(first)) return 0;
  uint64_t sent = first.ByteSizeLong();
  for (Request message; !mesh.empty(); mesh.remove_prefix(std::min(mesh.size(), kPieceBytes))) {
    message.set_mesh_piece(std::string(mesh.substr(0, kPieceBytes)));
    if (!stream.Write(message)) return sent;
    sent += message.ByteSizeLong();
  }
  stream.WritesDone();
  return sent;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_UPLOAD_H_
