#include "client/tool/cli/mesh_names.h"

#include <string>

#include "client/mesh/mesh_attributes.h"

namespace latvox::client {

CarriedNames NamesOf(const Mesh& mesh, const std::vector<Attribute>& attributes) {
  CarriedNames names;
  for (const Attribute attribute : attributes) {
    if (attribute == Attribute::kPart && !mesh.part_names.empty()) {
      names.parts = mesh.part_names;
      names.parts.resize(NextPart(mesh));
    }
    if (attribute == Attribute::kMaterial && !mesh.material_names.empty()) {
      names.materials = mesh.material_names;
      names.materials.resize(mesh.materials);
    }
  }
  return names;
}

}  // namespace latvox::client
