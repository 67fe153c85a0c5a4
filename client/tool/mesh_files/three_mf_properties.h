// What the triangles of 3MF carry.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_THREE_MF_PROPERTIES_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_THREE_MF_PROPERTIES_H_

#include <array>
#include <cstdint>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/tool/mesh_files/three_mf_part.h"

namespace latvox::client {

// The groups of properties in all of an archive's model files. Base materials are materials, with their displaycolor;
// a colorgroup's are colors alone; of others, as of textures, nothing is read. Materials are numbered by first use.
class ThreeMfProperties {
 public:
  struct Property {
    std::optional<uint32_t> material;
    Color color{};  // as the file has it: sRGB, without its alpha
  };

  // The groups of a model file, which must outlive this.
  void Add(const ThreeMfPart& part);

  // Errors, with the place of `node`, which has attribute `name`: no such group, none that is read, none with so many
  // properties, or one whose color is none.
  absl::StatusOr<Property> Find(const ThreeMfPart& part, const pugi::xml_node& node, const std::string& group,
                                const char* name, const pugi::xml_attribute& index);

  uint32_t materials() const { return materials_; }

 private:
  struct Group {
    std::string kind;                                // its element
    std::vector<pugi::xml_node> members;             // in order
    std::vector<std::optional<uint32_t>> materials;  // the numbers of those that were used
  };

  absl::flat_hash_map<std::pair<std::string, std::string>, Group> groups_;  // by file and id
  uint32_t materials_ = 0;
};

// The materials and colors of one object's triangles. What refers to nothing is missed only where it is asked for: the
// reason is then in Mesh::no_color.
class ThreeMfCarrier {
 public:
  // All must outlive it.
  ThreeMfCarrier(const ThreeMfPart& part, const pugi::xml_node& object, ThreeMfProperties& properties)
      : part_(part), object_(object), properties_(properties) {}

  // Before the triangle is added to the mesh.
  void Begin(const pugi::xml_node& triangle, Mesh& mesh);

  // After the last: gives the mesh its colors, if all triangles have some.
  void Finish(Mesh& mesh) const;

 private:
  struct Carried {
    std::optional<uint32_t> material;
    std::optional<std::array<Color, 3>> colors;  // of the corners
  };
  absl::StatusOr<Carried> ReadCarried(const pugi::xml_node& triangle);

  const ThreeMfPart& part_;
  const pugi::xml_node object_;
  ThreeMfProperties& properties_;
  std::optional<uint32_t> material_;          // of the triangle before
  std::vector<std::array<Color, 3>> colors_;  // of the triangles that have some
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_THREE_MF_PROPERTIES_H_
