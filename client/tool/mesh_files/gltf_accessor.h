// The numbers of a glTF file.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_ACCESSOR_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_ACCESSOR_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/json/json.h"
#include "client/tool/mesh_files/gltf_buffers.h"

namespace latvox::client {

// Elements of so many components one after the other.
struct GltfFloats {
  size_t components = 0;
  std::vector<float> values;
};

// Accessors, interleaved and sparse ones, too; without a buffer view all are 0.
//   accessor     one of the document's
// Errors, with accessor, field, value and limit: INVALID_ARGUMENT: what is missing, of a type that it cannot be, or
// reaches beyond what it lies in; RESOURCE_EXHAUSTED: more elements without a buffer view than anyone has.

// Integers as KHR_mesh_quantization has them: normalized ones are divided by the largest of their type, and not below
// -1, others are as they are.
absl::StatusOr<GltfFloats> ReadGltfFloats(uint64_t accessor, const SortedJson& root, GltfBuffers& buffers);

// Unsigned integers, one in each element.
absl::StatusOr<std::vector<uint32_t>> ReadGltfIndices(uint64_t accessor, const SortedJson& root, GltfBuffers& buffers);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_ACCESSOR_H_
