// Materials and colors of 3MF triangles.
#ifndef LATVOX_CLIENT_MESH_FILES_THREE_MF_PROPERTIES_H_
#define LATVOX_CLIENT_MESH_FILES_THREE_MF_PROPERTIES_H_

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
#include "client/mesh_files/three_mf_part.h"

namespace latvox::client {

// The groups of properties in all model files of an archive. Base materials are materials, with displaycolor as color.
// A colorgroup has only colors, and a texture2dgroup places in an image. Other groups are not read. Materials and
// textures are numbered by first use.
class ThreeMfProperties {
 public:
  struct Property {
    std::optional<uint32_t> material;
    Color color{};  // sRGB as in the file, without alpha; white for a texture
    uint32_t texture = TriangleBaseColor::kNone;
    ImagePoint place{};
  };

  // A <texture2d>.
  struct Texture {
    const ThreeMfPart* part;
    pugi::xml_node node;
  };

  explicit ThreeMfProperties(bool reads_textures) : reads_textures_(reads_textures) {}

  // Adds the groups of a model file, which must outlive this object.
  void Add(const ThreeMfPart& part);

  // Returns the property that `node` refers to with attribute `name`. Errors, with the place of `node`: the group does
  // not exist, is not read, or has too few properties; the color is not valid.
  absl::StatusOr<Property> Find(const ThreeMfPart& part, const pugi::xml_node& node, const std::string& group,
                                const char* name, const pugi::xml_attribute& index);

  uint32_t materials() const { return materials_; }
  const std::vector<std::string>& material_names() const { return material_names_; }  // as in Mesh
  const std::vector<Texture>& textures() const { return textures_; }                  // by number

 private:
  struct Group {
    pugi::xml_node node;
    std::string kind;                                // name of its element
    std::vector<pugi::xml_node> members;             // in order
    std::vector<std::optional<uint32_t>> materials;  // numbers of the used members
    uint32_t texture = TriangleBaseColor::kNone;     // its number, if used
  };

  absl::StatusOr<Property> FindPlace(const ThreeMfPart& part, Group& group, size_t number);

  absl::flat_hash_map<std::pair<std::string, std::string>, Group> groups_;  // keyed by file and id
  const bool reads_textures_;
  std::vector<Texture> textures_;
  uint32_t materials_ = 0;
  std::vector<std::string> material_names_;
};

// The materials and colors of one object's triangles. A dangling reference is an error only for a request that needs
// it: the reason is then in Mesh::no_color.
class ThreeMfCarrier {
 public:
  // All arguments must outlive the object.
  ThreeMfCarrier(const ThreeMfPart& part, const pugi::xml_node& object, ThreeMfProperties& properties)
      : part_(part), object_(object), properties_(properties) {}

  // Call it before the triangle is added to the mesh.
  void Begin(const pugi::xml_node& triangle, Mesh& mesh);

  // Call it after the last triangle. Stores the colors in the mesh.
  void Finish(Mesh& mesh) const;

  // Returns the number of triangles without a color. They are white, because the specification names no default.
  size_t bare() const { return bare_; }

 private:
  struct Carried {
    std::optional<uint32_t> material;
    std::optional<std::array<Color, 3>> colors;  // of the corners
    TriangleBaseColor texture = {};
  };
  absl::StatusOr<Carried> ReadCarried(const pugi::xml_node& triangle);

  const ThreeMfPart& part_;
  const pugi::xml_node object_;
  ThreeMfProperties& properties_;
  std::optional<uint32_t> material_;          // of the previous triangle
  std::vector<std::array<Color, 3>> colors_;  // of the triangles
  size_t bare_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_THREE_MF_PROPERTIES_H_
