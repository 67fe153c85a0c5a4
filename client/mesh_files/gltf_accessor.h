// The accessors of a glTF file.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_ACCESSOR_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_ACCESSOR_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/mesh_files/gltf_buffers.h"

namespace latvox::client {

// Elements of `components` numbers each, one after the other.
struct GltfNumbers {
  size_t components = 0;
  std::vector<double> values;
};

// Read an accessor, also an interleaved or sparse one. Without a buffer view all numbers are 0.
//   accessor   index in the document
// Errors, with accessor, field, value and limit:
//   INVALID_ARGUMENT     a field is missing, has an impossible type, or reaches beyond its buffer
//   RESOURCE_EXHAUSTED   more elements without a buffer view than the limit

// Floats keep their value. Converts integers by KHR_mesh_quantization, in double: normalized ones are divided by the
// largest value of their type and clamped at -1, others keep their value.
absl::StatusOr<GltfNumbers> ReadGltfNumbers(uint64_t accessor, const SortedJson& root, GltfBuffers& buffers);

// Reads unsigned integers, one per element.
absl::StatusOr<std::vector<uint32_t>> ReadGltfIndices(uint64_t accessor, const SortedJson& root, GltfBuffers& buffers);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_ACCESSOR_H_
