#include "client/mesh_files/bad_elements.h"

#include <algorithm>
#include <vector>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

constexpr char kBadElements[] = "BAD_ELEMENTS";

}  // namespace

absl::Status BadElements::Add(const absl::Status& error, const std::string& element) {
  if (!skip_) return error;
  if (count_++ == 0) first_ = Warning{kBadElements, std::string(error.message()), element};
  return absl::OkStatus();
}

void BadElements::Report(Mesh& mesh) const {
  if (count_ == 0) return;
  Warning warning = first_;
  warning.message = count_ == 1 ? absl::StrCat("1 broken element is left out: ", first_.message)
                                : absl::StrCat(count_, " broken elements are left out; the first: ", first_.message);
  mesh.warnings.push_back(std::move(warning));
}

std::string LeftOut(const Mesh& mesh) {
  for (const Warning& warning : mesh.warnings) {
    if (warning.code == kBadElements) return absl::StrCat("; ", warning.message);
  }
  return "";
}

void RemoveNotFinite(Mesh& mesh) {
  if (std::all_of(mesh.positions.begin(), mesh.positions.end(), IsFinite)) return;
  std::vector<uint32_t> numbers(mesh.positions.size());  // the new ones
  const bool colored = mesh.colors.size() == mesh.positions.size();
  uint32_t kept = 0;
  for (size_t v = 0; v < numbers.size(); ++v) {
    numbers[v] = kept;
    if (!IsFinite(mesh.positions[v])) continue;
    mesh.positions[kept] = mesh.positions[v];
    if (colored) mesh.colors[kept] = mesh.colors[v];
    ++kept;
  }
  mesh.positions.resize(kept);
  if (colored) mesh.colors.resize(kept);
  for (auto& triangle : mesh.triangles) {
    for (uint32_t& vertex : triangle) vertex = numbers[vertex];
  }
}

}  // namespace latvox::client
