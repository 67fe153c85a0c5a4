#include "client/mesh_files/gltf_accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/mesh_files/bad.h"

namespace latvox::client {
namespace {

constexpr uint64_t kMaxElements = uint64_t{1} << 22;  // limit without a buffer
constexpr uint64_t kMaxStride = 252;                  // limit of the specification

absl::Status In(absl::string_view where, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrCat(where, ": ", status.message()));
}

// Returns the bytes of a component of this type, or 0 if there is no such type.
uint64_t SizeOf(uint64_t component_type) {
  constexpr uint64_t kSizes[] = {1, 1, 2, 2, 0, 4, 4};
  return component_type >= 5120 && component_type <= 5126 ? kSizes[component_type - 5120] : 0;
}

bool IsIndex(uint64_t component_type) {
  return component_type == 5121 || component_type == 5123 || component_type == 5125;
}

// The elements of an accessor, packed, in the little-endian order of this machine.
struct Elements {
  uint64_t component_type = 0, components = 0, count = 0;
  std::string bytes = {};

  uint64_t size() const { return components * SizeOf(component_type); }
};

absl::StatusOr<uint64_t> ComponentsOf(const SortedJson& accessor) {
  constexpr std::pair<absl::string_view, uint64_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  const auto type = accessor.at("type").get<std::string>();
  for (const auto& [name, components] : kTypes) {
    if (type == name) return components;
  }
  return Bad("type \"", type, "\" is not one of SCALAR, VEC2, VEC3, VEC4, MAT4");
}

absl::Status ReadBase(const SortedJson& accessor, const SortedJson& root, GltfBuffers& buffers, Elements& elements) {
  const uint64_t size = elements.size(), count = elements.count;
  if (!accessor.contains("bufferView")) {
    if (count > kMaxElements) {
      return absl::ResourceExhaustedError(
          absl::StrCat("count ", count, " exceeds ", kMaxElements, ", the limit without a bufferView"));
    }
    elements.bytes.resize(count * size);
    return absl::OkStatus();
  }
  const auto number = GltfIndex(accessor, "bufferView", root, "bufferViews");
  if (!number.ok()) return number.status();
  const auto stride = GltfNumber(root.at("bufferViews").at(*number), "byteStride", size);
  if (!stride.ok()) return stride.status();
  if (*stride < size || *stride > kMaxStride) {
    return Bad("byteStride ", *stride, " is not within ", size, ", the size of an element, and ", kMaxStride);
  }
  const auto base = buffers.Bytes(accessor, count == 0 ? 0 : (count - 1) * *stride + size);
  if (!base.ok()) return base.status();
  elements.bytes.resize(count * size);
  for (uint64_t n = 0; n < count; ++n) std::copy_n(base->data() + n * *stride, size, &elements.bytes[n * size]);
  return absl::OkStatus();
}

// Applies the changes of a sparse accessor.
absl::Status ReadSparse(const SortedJson& sparse, GltfBuffers& buffers, Elements& elements) {
  const auto changes = GltfNumber(sparse, "count");
  if (!changes.ok()) return In("sparse", changes.status());
  if (*changes > elements.count) return Bad("sparse: count ", *changes, " exceeds the accessor's ", elements.count);
  const SortedJson &indices = sparse.at("indices"), &values = sparse.at("values");
  const auto type = GltfNumber(indices, "componentType");
  if (!type.ok()) return In("sparse.indices", type.status());
  if (!IsIndex(*type)) return Bad("sparse.indices: componentType ", *type, " is not one of 5121, 5123, 5125");
  const auto index_bytes = buffers.Bytes(indices, *changes * SizeOf(*type));
  if (!index_bytes.ok()) return In("sparse.indices", index_bytes.status());
  const auto value_bytes = buffers.Bytes(values, *changes * elements.size());
  if (!value_bytes.ok()) return In("sparse.values", value_bytes.status());
  for (uint64_t n = 0; n < *changes; ++n) {
    uint32_t index = 0;
    std::memcpy(&index, index_bytes->data() + n * SizeOf(*type), SizeOf(*type));
    if (index >= elements.count) {
      return Bad("sparse.indices: ", index, " at ", n, " is not below the count ", elements.count);
    }
    std::copy_n(value_bytes->data() + n * elements.size(), elements.size(), &elements.bytes[index * elements.size()]);
  }
  return absl::OkStatus();
}

absl::StatusOr<Elements> ReadElements(const SortedJson& accessor, const SortedJson& root, GltfBuffers& buffers) {
  const auto count = GltfNumber(accessor, "count"), type = GltfNumber(accessor, "componentType");
  const auto components = ComponentsOf(accessor);
  for (const auto* field : {&count, &type, &components}) {
    if (!field->ok()) return field->status();
  }
  if (*count > UINT32_MAX) return Bad("count ", *count, " exceeds ", UINT32_MAX);
  if (SizeOf(*type) == 0) return Bad("componentType ", *type, " is not one of glTF's");
  Elements elements{.component_type = *type, .components = *components, .count = *count};
  if (auto status = ReadBase(accessor, root, buffers, elements); !status.ok()) return status;
  if (const auto sparse = accessor.find("sparse"); sparse != accessor.end()) {
    if (auto status = ReadSparse(*sparse, buffers, elements); !status.ok()) return status;
  }
  return elements;
}

template <class T>
T NumberAt(const Elements& elements, uint64_t n) {
  T number;
  std::memcpy(&number, elements.bytes.data() + n * sizeof(T), sizeof(T));
  return number;
}

template <class T>
std::vector<double> ToDoubles(const Elements& elements, bool normalized) {
  std::vector<double> numbers(elements.count * elements.components);
  for (uint64_t n = 0; n < numbers.size(); ++n) {
    numbers[n] = NumberAt<T>(elements, n);
    if constexpr (std::is_integral_v<T>) {
      if (normalized) numbers[n] = std::max(numbers[n] / std::numeric_limits<T>::max(), -1.0);
    }
  }
  return numbers;
}

absl::StatusOr<std::vector<double>> ToDoubles(const Elements& elements, bool normalized) {
  switch (elements.component_type) {
    case 5120:
      return ToDoubles<int8_t>(elements, normalized);
    case 5121:
      return ToDoubles<uint8_t>(elements, normalized);
    case 5122:
      return ToDoubles<int16_t>(elements, normalized);
    case 5123:
      return ToDoubles<uint16_t>(elements, normalized);
    case 5126:
      return ToDoubles<float>(elements, normalized);
    default:
      return Bad("componentType ", elements.component_type, " is not one of 5120, 5121, 5122, 5123, 5126");
  }
}

// Returns `read`, with the number of the accessor before an error.
template <class Result, class Read>
absl::StatusOr<Result> OfAccessor(uint64_t number, const SortedJson& root, const Read& read) {
  absl::StatusOr<Result> result;
  try {
    result = read(root.at("accessors").at(number));
  } catch (const SortedJson::exception& error) {
    result = GltfError(error);
  }
  if (!result.ok()) return In(absl::StrCat("accessors[", number, "]"), result.status());
  return result;
}

}  // namespace

absl::StatusOr<GltfNumbers> ReadGltfNumbers(uint64_t accessor, const SortedJson& root, GltfBuffers& buffers) {
  return OfAccessor<GltfNumbers>(accessor, root, [&](const SortedJson& described) -> absl::StatusOr<GltfNumbers> {
    const auto elements = ReadElements(described, root, buffers);
    if (!elements.ok()) return elements.status();
    auto values = ToDoubles(*elements, described.value("normalized", false));
    if (!values.ok()) return values.status();
    return GltfNumbers{elements->components, *std::move(values)};
  });
}

absl::StatusOr<std::vector<uint32_t>> ReadGltfIndices(uint64_t accessor, const SortedJson& root, GltfBuffers& buffers) {
  using Indices = std::vector<uint32_t>;
  return OfAccessor<Indices>(accessor, root, [&](const SortedJson& described) -> absl::StatusOr<Indices> {
    const auto elements = ReadElements(described, root, buffers);
    if (!elements.ok()) return elements.status();
    const uint64_t type = elements->component_type;
    if (!IsIndex(type) || elements->components != 1) {
      return Bad("indices are ", described.at("type").dump(), " of componentType ", type,
                 ", not \"SCALAR\" of 5121, 5123 or 5125");
    }
    Indices indices(elements->count);
    for (uint64_t n = 0; n < indices.size(); ++n) {
      indices[n] = type == 5121   ? NumberAt<uint8_t>(*elements, n)
                   : type == 5123 ? NumberAt<uint16_t>(*elements, n)
                                  : NumberAt<uint32_t>(*elements, n);
    }
    return indices;
  });
}

}  // namespace latvox::client
