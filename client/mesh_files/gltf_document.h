// The JSON of a glTF file, and access to its fields.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_DOCUMENT_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_DOCUMENT_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/json/json.h"
#include "latvox/warning.h"

namespace latvox::client {

struct GltfDocument {
  SortedJson root;
  absl::string_view binary;  // the chunk of a .glb; null if there is none
  std::vector<Warning> warnings;
};

// Splits a .glb or .gltf. `bytes` must outlive the result. Errors: INVALID_ARGUMENT naming one of these:
//   the byte where the file is cut short or is not JSON
//   a version other than 2.0
//   a required extension that this reader lacks and that may move triangles
// Warnings: UNKNOWN_EXTENSION for such an extension that is not required.
absl::StatusOr<GltfDocument> ParseGltfDocument(absl::string_view bytes);

// Returns a field that is a whole number. Errors: INVALID_ARGUMENT: it is missing and there is no `otherwise`, or it is
// not a whole number.
absl::StatusOr<uint64_t> GltfNumber(const SortedJson& object, const char* name,
                                    std::optional<uint64_t> otherwise = std::nullopt);

// Returns `value`, a field of that name that numbers an element of one of the lists of the document. Errors:
// INVALID_ARGUMENT, also if the list has no such element.
absl::StatusOr<uint64_t> GltfElement(const SortedJson& value, const char* name, const SortedJson& root,
                                     const char* list);

// Does the same for a field of an object.
absl::StatusOr<uint64_t> GltfIndex(const SortedJson& object, const char* name, const SortedJson& root, const char* list,
                                   std::optional<uint64_t> otherwise = std::nullopt);

// Converts an exception of the JSON library about a missing field or one of another type.
absl::Status GltfError(const SortedJson::exception& error);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_DOCUMENT_H_
