#include "client/mesh_files/three_mf_properties.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/number_text.h"

namespace latvox::client {
namespace {

constexpr Color kWhite = {255, 255, 255};
constexpr char kBaseMaterials[] = "basematerials", kColorGroup[] = "colorgroup", kTextureGroup[] = "texture2dgroup";

// Parses "#RRGGBB" or "#RRGGBBAA".
std::optional<Color> ParseColor(absl::string_view text) {
  if ((text.size() != 7 && text.size() != 9) || text[0] != '#') return std::nullopt;
  uint32_t number = 0;
  text.remove_prefix(1);
  if (!std::all_of(text.begin(), text.end(), absl::ascii_isxdigit) || !absl::SimpleHexAtoi(text, &number)) {
    return std::nullopt;
  }
  if (text.size() == 8) number >>= 8;
  return Color{static_cast<uint8_t>(number >> 16), static_cast<uint8_t>(number >> 8), static_cast<uint8_t>(number)};
}

}  // namespace

void ThreeMfProperties::Add(const ThreeMfPart& part) {
  for (const pugi::xml_node& node : Child(part.root(), "resources")) {
    const std::string kind(LocalName(node.name()));
    if (kind == "object") continue;
    Group group;
    group.node = node;
    group.kind = kind;
    const absl::string_view member = kind == kBaseMaterials  ? "base"
                                     : kind == kColorGroup   ? "color"
                                     : kind == kTextureGroup ? "tex2coord"
                                                             : "";
    for (const pugi::xml_node& child : node) {
      if (LocalName(child.name()) == member) group.members.push_back(child);
    }
    group.materials.resize(kind == kBaseMaterials ? group.members.size() : 0);
    groups_.emplace(std::pair(part.name(), std::string(TextOf(node.attribute("id")))), std::move(group));
  }
}

absl::StatusOr<ThreeMfProperties::Property> ThreeMfProperties::Find(const ThreeMfPart& part, const pugi::xml_node& node,
                                                                    const std::string& group, const char* name,
                                                                    const pugi::xml_attribute& index) {
  const auto found = groups_.find(std::pair(part.name(), group));
  if (found == groups_.end()) return part.Error(node, "pid=\"", group, "\" is not a group of properties");
  Group& in = found->second;
  const bool is_texture = in.kind == kTextureGroup && reads_textures_;
  if (in.kind != kBaseMaterials && in.kind != kColorGroup && !is_texture) {
    return part.Error(node, "pid=\"", group, "\" is a <", in.kind, ">, and only ", kBaseMaterials, ", ", kColorGroup,
                      " and ", kTextureGroup, " are read");
  }
  size_t number = 0;
  if (!absl::SimpleAtoi(index.value(), &number) || number >= in.members.size()) {
    return part.Error(node, name, "=\"", index.value(), "\" is not within the ", in.members.size(), " of <", in.kind,
                      "> ", group);
  }
  if (is_texture) return FindPlace(part, in, number);
  const bool is_material = in.kind == kBaseMaterials;
  const absl::string_view text = TextOf(AttributeOf(in.members[number], is_material ? "displaycolor" : "color"));
  const auto color = ParseColor(text);
  if (!color) return part.Error(in.members[number], "\"", text, "\" is not a color #RRGGBB or #RRGGBBAA");
  if (is_material && !in.materials[number]) {
    SetName(materials_, AttributeOf(in.members[number], "name").value(), material_names_);
    in.materials[number] = materials_++;
  }
  return Property{is_material ? in.materials[number] : std::nullopt, *color};
}

// Reads a place in the image of a texture group. v points up there.
absl::StatusOr<ThreeMfProperties::Property> ThreeMfProperties::FindPlace(const ThreeMfPart& part, Group& group,
                                                                         size_t number) {
  if (group.texture == TriangleBaseColor::kNone) {
    const std::string id(TextOf(AttributeOf(group.node, "texid")));
    const auto found = groups_.find(std::pair(part.name(), id));
    if (found == groups_.end() || found->second.kind != "texture2d") {
      return part.Error(group.node, "texid=\"", id, "\" is not a <texture2d>");
    }
    group.texture = static_cast<uint32_t>(textures_.size());
    textures_.push_back({&part, found->second.node});
  }
  const pugi::xml_node member = group.members[number];
  std::array<double, 2> uv{};
  for (size_t n = 0; n < 2; ++n) {
    const absl::string_view word = TextOf(AttributeOf(member, n == 0 ? "u" : "v"));
    if (ParseDouble(word, uv[n]) && std::isfinite(uv[n])) continue;
    return part.Error(member, "\"", word, "\" is not a finite number");
  }
  const ImagePoint place{static_cast<float>(uv[0]), static_cast<float>(1 - uv[1])};
  return Property{std::nullopt, kWhite, group.texture, place};
}

absl::StatusOr<ThreeMfCarrier::Carried> ThreeMfCarrier::ReadCarried(const pugi::xml_node& triangle) {
  const pugi::xml_attribute own = AttributeOf(triangle, "pid");
  const std::string group(TextOf(own ? own : AttributeOf(object_, "pid")));
  pugi::xml_attribute first = AttributeOf(triangle, "p1");
  const bool by_object = !first && !own;
  if (by_object) first = AttributeOf(object_, "pindex");
  if (group.empty() || (by_object && !first)) return Carried{};
  const auto property =
      properties_.Find(part_, by_object ? object_ : triangle, group, by_object ? "pindex" : "p1", first);
  if (!property.ok()) return property.status();
  Carried carried{property->material,
                  {{property->color, property->color, property->color}},
                  {property->texture, {property->place, property->place, property->place}}};
  for (size_t n = 1; n < 3 && !by_object && !property->material; ++n) {
    const char* const name = n == 1 ? "p2" : "p3";
    const pugi::xml_attribute index = AttributeOf(triangle, name);
    if (!index) continue;
    const auto other = properties_.Find(part_, triangle, group, name, index);
    if (!other.ok()) return other.status();
    (*carried.colors)[n] = other->color;
    carried.texture.corners[n] = other->place;
  }
  return carried;
}

void ThreeMfCarrier::Begin(const pugi::xml_node& triangle, Mesh& mesh) {
  const auto read = ReadCarried(triangle);
  if (!read.ok() && mesh.no_color.empty()) mesh.no_color = std::string(read.status().message());
  const Carried carried = read.ok() ? *read : Carried{};
  if (carried.material != material_) BeginStretch(0, carried.material, mesh);
  material_ = carried.material;
  bare_ += !carried.colors;
  if (carried.texture.number != TriangleBaseColor::kNone) {
    mesh.base_colors.triangles.resize(mesh.triangles.size());
    mesh.base_colors.triangles.push_back(carried.texture);
  }
  colors_.push_back(carried.colors.value_or(std::array<Color, 3>{kWhite, kWhite, kWhite}));
}

void ThreeMfCarrier::Finish(Mesh& mesh) const {
  if (bare_ < colors_.size()) return ColorCorners(colors_, mesh);
  mesh.colors.assign(mesh.positions.size(), kWhite);
}

}  // namespace latvox::client
