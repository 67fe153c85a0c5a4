// Messages that carry a mesh. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_MESH_PIECES_H_
#define LATVOX_CLIENT_INTERNAL_MESH_PIECES_H_

#include <cstdint>
#include <string>
#include <string_view>

namespace latvox::client {

// A mesh in pieces, as messages of the type Request; one at a time is in memory.
template <class Request>
class MeshPieces {
 public:
  static constexpr size_t kBytes = size_t{1} << 20;  // of a piece, except the last one

  explicit MeshPieces(std::string_view mesh) : rest_(mesh) {}

  // Whether all pieces have been taken.
  bool empty() const { return rest_.empty(); }

  // Returns the next piece, valid until the next call.
  const Request& Next() {
    const std::string_view piece = rest_.substr(0, kBytes);
    rest_.remove_prefix(piece.size());
    message_.set_mesh_piece(piece.data(), piece.size());
    return message_;
  }

 private:
  std::string_view rest_;
  Request message_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_MESH_PIECES_H_
