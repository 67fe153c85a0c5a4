#include "client/tool/cli/attributes_option.h"

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/output/output.h"

namespace latvox::client {
namespace {

const Names<Attribute>& AttributeNames() {
  static const auto* const kNames = new Names<Attribute>{
      {"part", Attribute::kPart}, {"material", Attribute::kMaterial}, {"color", Attribute::kColor}};
  return *kNames;
}

std::string CheckAttributes(const std::string& text) {
  std::set<absl::string_view> seen;
  for (const absl::string_view word : absl::StrSplit(text, ',')) {
    const auto has_name = [word](const auto& name) { return name.first == word; };
    if (std::none_of(AttributeNames().begin(), AttributeNames().end(), has_name)) {
      return absl::StrCat("\"", word, "\" is not one of part, material, color");
    }
    if (!seen.insert(word).second) return absl::StrCat("\"", word, "\" is given twice");
  }
  return "";
}

}  // namespace

OptionRow AttributesRow(VoxelizeWords& words) {
  return {.names = "--attributes",
          .target = &words.attributes,
          .help = "Attributes that each voxel takes from its nearest triangle: part, material, color, or a list",
          .value = "NAME,...",
          .checks = {{CheckAttributes}}};
}

void InterpretAttributes(const VoxelizeWords& words, VoxelizeOptions& options) {
  if (words.attributes.empty()) return;
  VoxelizeRequest& request = options.request;
  if (options.output_options.dense_npy) Refuse("--attributes excludes --npy dense");
  for (const absl::string_view word : absl::StrSplit(words.attributes, ',')) {
    request.attributes.push_back(ValueNamed(AttributeNames(), std::string(word)));
  }
  options.mesh.attributes = request.attributes;
  CheckCarry("--attributes", words.attributes, AttributeExtensions(request.attributes), options.outputs);
}

void CheckCarry(const char* option, absl::string_view what, const std::vector<std::string>& extensions,
                const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs) {
    if (HasExtension(output, extensions)) continue;
    Refuse(option, ": ", output, " cannot hold ", what, "; ", absl::StrJoin(extensions, " "), " can");
  }
}

}  // namespace latvox::client
