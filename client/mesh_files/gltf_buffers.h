// The bytes behind a glTF file's accessors.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_BUFFERS_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_BUFFERS_H_

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/json/json.h"
#include "client/mesh_files/gltf_document.h"

namespace latvox::client {

// Reads each buffer once, when it is first needed. Errors: INVALID_ARGUMENT naming the buffer that is missing or too
// short; also exceptions of the JSON library.
class GltfBuffers {
 public:
  // `document` must outlive the object. `folder` is that of the referenced files; empty: the working directory.
  GltfBuffers(const GltfDocument& document, std::filesystem::path folder)
      : document_(document), folder_(std::move(folder)) {}

  // Returns all bytes of the buffer view that `object` names.
  absl::StatusOr<absl::string_view> View(const SortedJson& object);

  // Returns `size` of these bytes, starting at object's byteOffset.
  absl::StatusOr<absl::string_view> Bytes(const SortedJson& object, uint64_t size);

 private:
  absl::StatusOr<absl::string_view> At(uint64_t n);

  const GltfDocument& document_;
  const std::filesystem::path folder_;
  std::map<uint64_t, std::string> read_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_BUFFERS_H_
