// The JSON of a glTF file, and fields of it.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_DOCUMENT_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_DOCUMENT_H_

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/tool/json/json.h"

namespace latvox::client {

struct GltfDocument {
  SortedJson root;
  absl::string_view binary;  // the chunk of a .glb; null if there is none
};

// Takes a .glb or a .gltf apart; `bytes` must outlive what it returns. Errors: INVALID_ARGUMENT naming the byte of what
// is cut short or no JSON, the version if it is not 2.0, or the extension that a reader must know and this one does
// not: all that may place triangles.
absl::StatusOr<GltfDocument> ParseGltfDocument(absl::string_view bytes);

// A field that is a whole number. Errors: INVALID_ARGUMENT: it is missing and there is no `otherwise`, it is none.
absl::StatusOr<uint64_t> GltfNumber(const SortedJson& object, const char* name,
                                    std::optional<uint64_t> otherwise = std::nullopt);

// `value`, a field of that name, which numbers an element of one of the document's lists. Errors: INVALID_ARGUMENT:
// also if that has none such.
absl::StatusOr<uint64_t> GltfElement(const SortedJson& value, const char* name, const SortedJson& root,
                                     const char* list);

// The same of an object's field.
absl::StatusOr<uint64_t> GltfIndex(const SortedJson& object, const char* name, const SortedJson& root, const char* list,
                                   std::optional<uint64_t> otherwise = std::nullopt);

// What the JSON library says of a field that is missing or of another type.
absl::Status GltfError(const SortedJson::exception& error);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_DOCUMENT_H_
