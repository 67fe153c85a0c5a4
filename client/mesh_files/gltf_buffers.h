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
#include "client/mesh_files/decode.h"
#include "client/mesh_files/gltf_document.h"

namespace latvox::client {

// Reads each buffer once, when it is first needed. Does the same with the streams of compressed buffer views
// (gltf_meshopt.h). A view whose stream is newer than the decoder has the bytes of its own buffer, if the extension is
// not required.
// Errors: INVALID_ARGUMENT naming the buffer that is missing or too short, or the buffer view and its field;
// RESOURCE_EXHAUSTED naming the view with which the decoded streams exceed the limit; also exceptions of the JSON
// library.
class GltfBuffers {
 public:
  // `document` must outlive the object. `folder` is that of the referenced files; empty: the working directory.
  // `most` is the limit of the bytes of all decoded streams together.
  GltfBuffers(const GltfDocument& document, std::filesystem::path folder, uint64_t most = kMostUnpacked)
      : document_(document), folder_(std::move(folder)), left_(most) {}

  // Returns all bytes of the buffer view that `object` names.
  absl::StatusOr<absl::string_view> View(const SortedJson& object);

  // Returns the bytes behind a URI: those of a data: URI, or of a regular file in the folder.
  absl::StatusOr<std::string> Uri(absl::string_view uri) const;

  // Returns `size` of these bytes, starting at object's byteOffset.
  absl::StatusOr<absl::string_view> Bytes(const SortedJson& object, uint64_t size);

 private:
  absl::StatusOr<absl::string_view> At(uint64_t n);
  absl::StatusOr<absl::string_view> Range(const SortedJson& object, const std::string& place);
  absl::StatusOr<absl::string_view> Decoded(uint64_t n);

  const GltfDocument& document_;
  const std::filesystem::path folder_;
  std::map<uint64_t, std::string> read_;     // by number of the buffer
  std::map<uint64_t, std::string> decoded_;  // by number of the buffer view
  uint64_t left_;                            // of the limit
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_BUFFERS_H_
