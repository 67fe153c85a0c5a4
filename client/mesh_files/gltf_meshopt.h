// EXT_meshopt_compression and KHR_meshopt_compression of glTF.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_MESHOPT_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_MESHOPT_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/json/json.h"

namespace latvox::client {

// A decoded stream has at most this many times its bytes, whatever it declares.
inline constexpr uint64_t kMostMeshoptGrowth = 64;

// An extension in a buffer view, or in a buffer.
struct GltfMeshopt {
  absl::string_view name;              // of the extension
  const SortedJson* object = nullptr;  // null: there is none
};

// Returns the extension of a buffer view or of a buffer. The result refers to `owner`.
GltfMeshopt GltfMeshoptOf(const SortedJson& owner);

// Returns whether the stream needs a decoder that is newer than this one. KHR_meshopt_compression has added version 1
// of the mode ATTRIBUTES, and the filter COLOR.
bool IsNewerMeshopt(const SortedJson& extension, absl::string_view stream);

// Decodes the stream of a buffer view.
//   extension   the object in the buffer view
//   view        the buffer view
//   stream      the bytes that the extension names
//   most        most bytes of the result
// Errors: INVALID_ARGUMENT naming field, value and limit: the field is missing, contradicts the specification or
// another one; the stream is damaged, cut short, or newer than this decoder. RESOURCE_EXHAUSTED: more than `most`
// bytes. Also exceptions of the JSON library.
absl::StatusOr<std::string> DecodeGltfMeshopt(const SortedJson& extension, const SortedJson& view,
                                              absl::string_view stream, uint64_t most);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_MESHOPT_H_
