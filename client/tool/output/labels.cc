#include "client/tool/output/labels.h"

#include <algorithm>

#include "client/tool/output/file_metadata.h"
#include "latvox/grid/carried_names.h"

namespace latvox::client {

Field FieldOfLabels(const GridFileInfo& info) {
  const SortedJson request = RequestIn(info);
  const bool by_material = request.is_object() && request.value("labels", SortedJson()) == NameOf(Field::kMaterial);
  return by_material ? Field::kMaterial : Field::kPart;
}

std::string NameOfLabel(const GridFileInfo& info, uint32_t label) {
  return ReadCarriedNames(info).Of(FieldOfLabels(info), label);
}

FieldValues FractionOf(const FieldValues& fractions, std::span<const uint32_t> labels) {
  const std::span<const uint16_t> numbers = fractions.As<uint16_t>();
  const size_t columns = fractions.labels.size();
  FieldValues sum{Field::kFraction};
  sum.bytes.resize(numbers.size() / columns * sizeof(uint16_t));
  auto* const sums = reinterpret_cast<uint16_t*>(sum.bytes.data());
  for (size_t column = 0; column < columns; ++column) {
    if (std::ranges::find(labels, fractions.labels[column]) == labels.end()) continue;
    for (size_t voxel = 0; voxel < numbers.size() / columns; ++voxel) {
      sums[voxel] = static_cast<uint16_t>(sums[voxel] + numbers[voxel * columns + column]);
    }
  }
  return sum;
}

}  // namespace latvox::client
