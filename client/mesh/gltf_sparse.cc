#include "client/mesh/gltf_sparse.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace latvox::client {
namespace {

using Json = nlohmann::json;

constexpr uint64_t kMaxElements = uint64_t{1} << 26;  // without a buffer that bounds them

template <class... Parts>
absl::Status Bad(const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat(parts...));
}

// A field that assimp, too, takes for a whole number: one with a point or a sign is missing there, and missed.
absl::StatusOr<uint64_t> Whole(const Json& object, const char* name, std::optional<uint64_t> otherwise = {}) {
  const auto found = object.find(name);
  if (found == object.end() && otherwise) return *otherwise;
  if (found == object.end()) return Bad(name, " is missing");
  if (!found->is_number_unsigned() || found->get<uint64_t>() > UINT32_MAX) {
    return Bad(name, ": ", found->dump(), " is not a whole number from 0 to ", UINT32_MAX);
  }
  return found->get<uint64_t>();
}

// So many bytes of a view from `object`'s byteOffset on.
absl::StatusOr<absl::string_view> BytesAt(const Json& object, uint64_t size, const Json& root, GltfBuffers& buffers) {
  const auto number = Whole(object, "bufferView"), offset = Whole(object, "byteOffset", 0);
  if (!number.ok() || !offset.ok()) return number.ok() ? offset.status() : number.status();
  const Json& views = root.at("bufferViews");
  if (*number >= views.size()) return Bad("bufferView ", *number, " is not among the ", views.size());
  const Json& view = views[*number];
  const auto buffer = Whole(view, "buffer"), begin = Whole(view, "byteOffset", 0), length = Whole(view, "byteLength");
  for (const auto* field : {&buffer, &begin, &length}) {
    if (!field->ok()) return Bad("bufferViews[", *number, "]: ", field->status().message());
  }
  if (*offset + size > *length) {
    return Bad("needs bytes ", *offset, " to ", *offset + size, " of bufferView ", *number, ", which has ", *length);
  }
  const absl::string_view bytes = buffers.At(*buffer);
  if (*begin + *length > bytes.size()) {
    return Bad("bufferViews[", *number, "] ends at byte ", *begin + *length, " of buffer ", *buffer, ", which has ",
               bytes.size());
  }
  return bytes.substr(*begin + *offset, size);
}

// How an accessor's elements lie.
struct Layout {
  uint64_t count = 0, element = 0;          // bytes
  uint64_t changed = 0, index = 0;          // elements; bytes of the number of each
  absl::string_view base, indices, values;  // base: empty if all are 0
};

absl::StatusOr<uint64_t> ElementSize(const Json& accessor) {
  constexpr std::pair<absl::string_view, uint64_t> kTypes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                               {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
  const auto component = Whole(accessor, "componentType");
  if (!component.ok()) return component.status();
  const uint64_t size = GltfComponentSize(static_cast<int>(*component));
  if (size == 0) return Bad("componentType ", *component, " is not one of glTF's");
  const std::string type = accessor.at("type").get<std::string>();
  for (const auto& [name, components] : kTypes) {
    if (type == name) return components * size;
  }
  return Bad("type \"", type, "\" is not one of glTF's");
}

absl::StatusOr<uint64_t> IndexSize(const Json& indices) {
  const auto type = Whole(indices, "componentType");
  if (!type.ok()) return type.status();
  if (!IsGltfIndex(static_cast<int>(*type))) {
    return Bad("componentType ", *type, " is not one of 5121, 5123, 5125");
  }
  return GltfComponentSize(static_cast<int>(*type));
}

absl::Status In(const char* where, const absl::Status& status) { return Bad(where, ": ", status.message()); }

// The base that is changed.
absl::Status LayBase(const Json& accessor, const Json& root, GltfBuffers& buffers, Layout& layout) {
  if (!accessor.contains("bufferView")) {
    if (layout.count <= kMaxElements) return absl::OkStatus();
    return absl::ResourceExhaustedError(
        absl::StrCat("count ", layout.count, " exceeds ", kMaxElements, ", the most without a bufferView"));
  }
  auto base = BytesAt(accessor, layout.count * layout.element, root, buffers);
  if (!base.ok()) return base.status();
  const auto stride =
      Whole(root.at("bufferViews")[accessor.at("bufferView").get<size_t>()], "byteStride", layout.element);
  if (!stride.ok()) return stride.status();
  if (*stride != layout.element) return Bad("byteStride ", *stride, " is not ", layout.element, ": not read if sparse");
  layout.base = *base;
  return absl::OkStatus();
}

absl::StatusOr<Layout> LayoutOf(const Json& accessor, const Json& root, GltfBuffers& buffers) {
  const auto count = Whole(accessor, "count"), element = ElementSize(accessor);
  if (!count.ok() || !element.ok()) return count.ok() ? element.status() : count.status();
  Layout layout;
  layout.count = *count;
  layout.element = *element;
  if (auto status = LayBase(accessor, root, buffers, layout); !status.ok()) return status;
  const Json& sparse = accessor.at("sparse");
  const auto changed = Whole(sparse, "count");
  if (!changed.ok()) return In("sparse", changed.status());
  if (*changed > *count) return Bad("sparse: count ", *changed, " exceeds the accessor's ", *count);
  const Json& indices = sparse.at("indices");
  const auto size = IndexSize(indices);
  if (!size.ok()) return In("sparse.indices", size.status());
  const auto index_bytes = BytesAt(indices, *changed * *size, root, buffers);
  if (!index_bytes.ok()) return In("sparse.indices", index_bytes.status());
  const auto values = BytesAt(sparse.at("values"), *changed * *element, root, buffers);
  if (!values.ok()) return In("sparse.values", values.status());
  layout.changed = *changed;
  layout.index = *size;
  layout.indices = *index_bytes;
  layout.values = *values;
  return layout;
}

// Which element the n-th change is of.
uint32_t ElementAt(const Layout& layout, uint64_t n) {
  uint32_t element = 0;
  std::memcpy(&element, layout.indices.data() + n * layout.index, layout.index);  // little-endian, as this machine is
  return element;
}

absl::Status CheckAccessor(const Json& accessor, const Json& root, GltfBuffers& buffers) try {
  const auto layout = LayoutOf(accessor, root, buffers);
  if (!layout.ok()) return layout.status();
  for (uint64_t n = 0; n < layout->changed; ++n) {
    const uint32_t element = ElementAt(*layout, n);
    if (element >= layout->count) {
      return Bad("sparse.indices: ", element, " at ", n, " is not below the count ", layout->count);
    }
  }
  return absl::OkStatus();
} catch (const Json::exception& error) {
  const absl::string_view what = error.what();  // "[json.exception.out_of_range.403] key 'values' not found"
  return Bad("sparse: ", what.substr(what.find("] ") + 2));
}

}  // namespace

absl::Status CheckSparse(const Json& root, GltfBuffers& buffers) {
  const auto accessors = root.find("accessors");
  if (accessors == root.end() || !accessors->is_array()) return absl::OkStatus();
  for (size_t n = 0; n < accessors->size(); ++n) {
    const Json& accessor = (*accessors)[n];
    if (!accessor.contains("sparse")) continue;
    const absl::Status status = CheckAccessor(accessor, root, buffers);
    if (!status.ok()) return absl::Status(status.code(), absl::StrCat("accessors[", n, "]: ", status.message()));
  }
  return absl::OkStatus();
}

std::string SparseBytes(const Json& accessor, const Json& root, GltfBuffers& buffers) {
  const Layout layout = LayoutOf(accessor, root, buffers).value();
  std::string bytes(layout.base);
  bytes.resize(layout.count * layout.element);
  for (uint64_t n = 0; n < layout.changed; ++n) {
    std::copy_n(&layout.values[n * layout.element], layout.element, &bytes[ElementAt(layout, n) * layout.element]);
  }
  return bytes;
}

}  // namespace latvox::client
