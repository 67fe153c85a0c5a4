#include "client/tool/cli/mesh_names.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_attributes.h"
#include "client/tool/cli/common_options.h"

namespace latvox::client {

CarriedNames NamesOf(const Mesh& mesh, const std::vector<Field>& attributes) {
  CarriedNames names;
  for (const Field attribute : attributes) {
    if (attribute == Field::kPart && !mesh.part_names.empty()) {
      names.parts = mesh.part_names;
      names.parts.resize(NextPart(mesh));
    }
    if (attribute == Field::kMaterial && !mesh.material_names.empty()) {
      names.materials = mesh.material_names;
      names.materials.resize(mesh.materials);
    }
  }
  return names;
}

absl::StatusOr<std::vector<uint32_t>> LabelsNamed(const std::vector<std::string>& words, const std::string& option,
                                                  Field labels, const CarriedNames& names) {
  std::vector<uint32_t> numbers;
  for (const std::string& word : words) {
    uint32_t number = 0;
    if (ParseNumber(word, number)) {
      numbers.push_back(number);
      continue;
    }
    const std::vector<std::string>& known = names.Of(labels);
    const size_t before = numbers.size();
    for (size_t n = known.size(); n-- > 0;) {
      if (known[n] == word) numbers.push_back(static_cast<uint32_t>(n));
    }
    if (numbers.size() > before) continue;
    return ToStatus(
        UsageError(absl::StrCat(option, ": \"", word, "\" is neither a number nor the name of a ", NameOf(labels)),
                   {option, word}));
  }
  return numbers;
}

}  // namespace latvox::client
