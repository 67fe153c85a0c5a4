#include "client/tool/cli/mesh_names.h"

#include <string>

#include "client/mesh/mesh_attributes.h"

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

}  // namespace latvox::client
