#include "client/mesh_files/three_mf_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <pugixml.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/mesh/affine.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/mesh_join.h"
#include "client/mesh_files/number_text.h"
#include "client/mesh_files/three_mf_part.h"
#include "client/mesh_files/three_mf_properties.h"
#include "client/mesh_files/zip_archive.h"

// No assimp, although it has an importer: it trusts the archive's declared sizes with memory, ignores the unit, reads
// only the first model file and misses the nearest number. No lib3mf 1.8: it refuses degenerate triangles.
namespace latvox::client {
namespace {

constexpr uint64_t kMaxBytes = uint64_t{1} << 30;
constexpr size_t kMaxObjects = size_t{1} << 20;
constexpr int kMaxDepth = 64;  // nesting of components
constexpr char kProduction[] = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
constexpr char kMaterials[] = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";
// Slices stand beside a mesh, and sets of triangles name some.
constexpr char kSlices[] = "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07";
constexpr char kTriangleSets[] = "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07";

absl::Status ReadThreeMfVertex(const ThreeMfPart& part, const pugi::xml_node& node, std::vector<Vec3d>& positions) {
  Vec3d& position = positions.emplace_back();
  for (size_t m = 0; m < 3; ++m) {
    const char* const name = m == 0 ? "x" : m == 1 ? "y" : "z";
    const absl::string_view word = TextOf(AttributeOf(node, name));
    if (!ParseDouble(word, position[m]) || !std::isfinite(position[m])) {
      return part.Error(node, name, "=\"", word, "\" of vertex ", positions.size() - 1, " is not a finite number");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::array<uint32_t, 3>> ReadTriangle(const ThreeMfPart& part, const pugi::xml_node& node,
                                                     const Mesh& mesh) {
  std::array<uint32_t, 3> triangle{};
  for (size_t n = 0; n < 3; ++n) {
    const char* const name = n == 0 ? "v1" : n == 1 ? "v2" : "v3";
    const absl::string_view word = AttributeOf(node, name).value();
    if (!absl::SimpleAtoi(word, &triangle[n]) || triangle[n] >= mesh.positions.size()) {
      return part.Error(node, name, "=\"", word, "\" of triangle ", mesh.triangles.size(), " is not within the ",
                        mesh.positions.size(), " vertices");
    }
  }
  for (const uint32_t vertex : triangle) {
    if (!IsFinite(mesh.positions[vertex])) return part.Error(node, "has vertex ", vertex, ", which is left out");
  }
  return triangle;
}

struct ThreeMfObject {
  Mesh mesh;
  size_t bare = 0;  // triangles without a color
};

// Reads the mesh of `object`, whose properties are the default of its triangles.
absl::StatusOr<ThreeMfObject> ReadMesh(const ThreeMfPart& part, const pugi::xml_node& object,
                                       ThreeMfProperties& properties, BadElements& bad) {
  const pugi::xml_node node = Child(object, "mesh");
  Mesh mesh;
  for (const pugi::xml_node& vertex : Child(node, "vertices")) {
    if (LocalName(vertex.name()) != "vertex") continue;
    const absl::Status read = ReadThreeMfVertex(part, vertex, mesh.positions);
    if (read.ok()) continue;
    if (auto status = bad.Add(read, absl::StrCat("vertex ", mesh.positions.size() - 1)); !status.ok()) return status;
    mesh.positions.back()[0] = std::numeric_limits<double>::quiet_NaN();
  }
  ThreeMfCarrier carrier(part, object, properties);
  for (const pugi::xml_node& triangle : Child(node, "triangles")) {
    if (LocalName(triangle.name()) != "triangle") continue;
    const auto read = ReadTriangle(part, triangle, mesh);
    if (!read.ok()) {
      if (auto status = bad.Add(read.status(), "a triangle"); !status.ok()) return status;
      continue;
    }
    carrier.Begin(triangle, mesh);
    mesh.triangles.push_back(*read);
  }
  carrier.Finish(mesh);
  RemoveNotFinite(mesh);
  return ThreeMfObject{std::move(mesh), carrier.bare()};
}

// Reads twelve numbers: the rows of a matrix for row vectors, without its last column.
absl::StatusOr<Affine> ReadTransform(const ThreeMfPart& part, const pugi::xml_node& node) {
  const pugi::xml_attribute attribute = AttributeOf(node, "transform");
  if (!attribute) return kIdentity;
  const std::vector<absl::string_view> words =
      absl::StrSplit(attribute.value(), absl::ByAnyChar(" \t\r\n"), absl::SkipEmpty());
  Affine map{};
  for (size_t n = 0; n < 12 && words.size() == 12; ++n) {
    double& number = map[n % 3][n / 3];
    if (absl::SimpleAtod(words[n], &number) && std::isfinite(number)) continue;
    return part.Error(node, "transform: \"", words[n], "\" is not a finite number");
  }
  if (words.size() != 12) return part.Error(node, "transform has ", words.size(), " numbers, not 12");
  return map;
}

absl::StatusOr<double> MillimetersOf(const ThreeMfPart& part) {
  constexpr std::pair<absl::string_view, double> kUnits[] = {{"micron", 0.001}, {"millimeter", 1}, {"centimeter", 10},
                                                             {"inch", 25.4},    {"foot", 304.8},   {"meter", 1000}};
  const pugi::xml_attribute unit = AttributeOf(part.root(), "unit");
  for (const auto& [name, millimeters] : kUnits) {
    if (name == (unit ? TextOf(unit) : "millimeter")) return millimeters;
  }
  return part.Error(part.root(), "unit \"", unit.value(),
                    "\" is not one of micron millimeter centimeter inch foot meter");
}

// Required extensions are namespaces, and the file chooses their prefixes.
absl::Status CheckRequiredExtensions(const ThreeMfPart& part) {
  const absl::string_view required = part.root().attribute("requiredextensions").value();
  for (const absl::string_view prefix : absl::StrSplit(required, absl::ByAnyChar(" \t\r\n"), absl::SkipEmpty())) {
    const absl::string_view space = part.root().attribute(absl::StrCat("xmlns:", prefix).c_str()).value();
    if (space == kProduction || space == kMaterials || space == kSlices || space == kTriangleSets) continue;
    return part.Error(part.root(), "requires the extension \"", prefix, "\" (", space, "), which is not read");
  }
  return absl::OkStatus();
}

class Reader {
 public:
  Reader(ZipArchive archive, const ParseOptions& options)
      : archive_(std::move(archive)), bad_(options), properties_(options.base_colors) {
    const size_t foreign = archive_.foreign_bytes();
    if (foreign == 0) return;
    mesh_.warnings.push_back(
        {"TRAILING_DATA", absl::StrCat(foreign, " bytes before or after the archive are not read")});
  }

  absl::StatusOr<Mesh> Read() {
    const auto name = ModelName();
    if (!name.ok()) return name.status();
    const auto part = PartNamed(*name);
    if (!part.ok()) return part.status();
    const auto millimeters = MillimetersOf(**part);
    if (!millimeters.ok()) return millimeters.status();
    const pugi::xml_node build = Child((*part)->root(), "build");
    for (const pugi::xml_node& item : build) {
      if (LocalName(item.name()) != "item") continue;
      if (auto status = Place(**part, item, Scaling(*millimeters), 0); !status.ok()) return status;
    }
    if (placed_ == 0) return (*part)->Error((*part)->root(), "the build has no item and places no object");
    mesh_.materials = properties_.materials();
    mesh_.material_names = properties_.material_names();
    FinishColors();
    if (auto status = ReadTextures(); !status.ok()) return status;
    bad_.Report(mesh_);
    return std::move(mesh_);
  }

 private:
  using Objects = absl::flat_hash_map<std::string, pugi::xml_node>;

  struct Model {
    std::unique_ptr<ThreeMfPart> part;
    Objects objects;
  };

  // Returns the file that the archive's relations declare as the model.
  absl::StatusOr<std::string> ModelName() {
    auto text = archive_.Read("_rels/.rels");
    if (!text.ok()) return text.status();
    const auto part = ThreeMfPart::Parse("_rels/.rels", *std::move(text));
    if (!part.ok()) return part.status();
    for (const pugi::xml_node& relation : (*part)->root()) {
      if (absl::EndsWith(relation.attribute("Type").value(), "/3dmodel")) return relation.attribute("Target").value();
    }
    return (*part)->Error((*part)->root(), "names no 3D model");
  }

  absl::StatusOr<const ThreeMfPart*> PartNamed(absl::string_view given) {
    const std::string name(absl::StripPrefix(given, "/"));
    const auto found = models_.find(name);
    if (found != models_.end()) return found->second.part.get();
    auto text = archive_.Read(name);
    if (!text.ok()) return text.status();
    auto part = ThreeMfPart::Parse(name, *std::move(text));
    if (!part.ok()) return part.status();
    if (LocalName((*part)->root().name()) != "model") return (*part)->Error((*part)->root(), "is not <model>");
    if (auto status = CheckRequiredExtensions(**part); !status.ok()) return status;
    Model& model = models_[name];
    for (const pugi::xml_node& object : Child((*part)->root(), "resources")) {
      if (LocalName(object.name()) == "object") model.objects.emplace(TextOf(object.attribute("id")), object);
    }
    properties_.Add(**part);
    model.part = *std::move(part);
    return model.part.get();
  }

  // Places the object that an <item> or <component> refers to.
  absl::Status Place(const ThreeMfPart& part, const pugi::xml_node& reference, const Affine& outer, int depth) {
    const auto map = ReadTransform(part, reference);
    if (!map.ok()) return map.status();
    const pugi::xml_attribute path = AttributeOf(reference, "path");
    const auto home = path ? PartNamed(TextOf(path)) : &part;
    if (!home.ok()) return home.status();
    const std::string id(TextOf(reference.attribute("objectid")));
    const Objects& objects = models_[(*home)->name()].objects;
    const auto object = objects.find(id);
    if (object == objects.end())
      return part.Error(reference, "objectid=\"", id, "\" is not an object of ", (*home)->name());
    if (depth > kMaxDepth) return part.Error(reference, "components nest deeper than ", kMaxDepth);
    if (++placed_ > kMaxObjects) {
      return absl::ResourceExhaustedError(absl::StrCat("the build places more than ", kMaxObjects, " objects"));
    }
    const pugi::xml_node node = object->second;  // models_ may grow below
    WarnOf(reference, node);
    const Affine to_world = outer * *map;
    for (const pugi::xml_node& component : Child(node, "components")) {
      if (LocalName(component.name()) != "component") continue;
      if (auto status = Place(**home, component, to_world, depth + 1); !status.ok()) return status;
    }
    if (Child(node, "mesh")) return AppendObject(**home, node, to_world);
    return absl::OkStatus();
  }

  absl::Status AppendObject(const ThreeMfPart& part, const pugi::xml_node& node, const Affine& to_world) {
    auto& read = meshes_[node.internal_object()];
    if (read == nullptr) {
      auto mesh = ReadMesh(part, node, properties_, bad_);
      if (!mesh.ok()) return mesh.status();
      SetName(0, AttributeOf(node, "name").value(), mesh->mesh.part_names);
      read = std::make_unique<ThreeMfObject>(*std::move(mesh));
    }
    const Mesh& mesh = read->mesh;
    if (std::max(mesh_.triangles.size() + mesh.triangles.size(), mesh_.positions.size() + mesh.positions.size()) >
        kMostPlaced) {
      return absl::ResourceExhaustedError(
          absl::StrCat("the build has more than ", kMostPlaced, " triangles or vertices"));
    }
    bare_ += read->bare;
    const absl::Status status = Append(mesh, to_world, mesh_);
    return status.ok() ? status : part.Error(node, status.message());
  }

  // Warns of an object that a printer would not make, or would make otherwise: once, however often it is placed.
  void WarnOf(const pugi::xml_node& reference, const pugi::xml_node& object) {
    const std::string element = absl::StrCat("object ", TextOf(object.attribute("id")));
    const absl::string_view type = TextOf(object.attribute("type")),
                            printable = TextOf(AttributeOf(reference, "printable"));
    const auto warn = [&](const char* code, const auto&... words) {
      if (!warned_.emplace(code, object.internal_object()).second) return;
      mesh_.warnings.push_back({code, absl::StrCat(element, words...), element});
    };
    if (type == "support" || type == "solidsupport" || type == "other") {
      warn("NOT_A_MODEL", " is of type ", type, ", and is placed like a model");
    }
    if (printable == "0" || printable == "false")
      warn("NOT_PRINTABLE", " is not to be printed, and is placed all the same");
    if (TextOf(AttributeOf(object, "meshresolution")) == "lowres") {
      warn("SLICES_NOT_READ", " has finer slices, which are not read");
    }
  }

  // Fills in the base colors, which the triangles number already.
  absl::Status ReadTextures() {
    for (const auto& [part, node] : properties_.textures()) {
      BaseColor& color = mesh_.base_colors.all.emplace_back();
      color.wraps = {WrapOf(node, "tilestyleu"), WrapOf(node, "tilestylev")};
      color.is_smooth = TextOf(AttributeOf(node, "filter")) != "nearest";
      const std::string path(absl::StripPrefix(TextOf(AttributeOf(node, "path")), "/"));
      auto bytes = archive_.Read(path);
      if (bytes.ok()) {
        color.image = std::make_shared<EncodedImage>(EncodedImage{path, *std::move(bytes)});
        continue;
      }
      const absl::Status error(bytes.status().code(), part->Error(node, bytes.status().message()).message());
      if (auto status = bad_.Add(error, absl::StrCat("texture ", path)); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  Wrap WrapOf(const pugi::xml_node& texture, const char* name) {
    const absl::string_view style = TextOf(AttributeOf(texture, name));
    if (style == "none") {
      const std::string element = absl::StrCat("texture ", TextOf(AttributeOf(texture, "path")));
      mesh_.warnings.push_back(
          {"IGNORED_TEXTURE", absl::StrCat(element, ": ", name, "=\"none\" is read as clamp"), element});
    }
    return style == "mirror" ? Wrap::kMirror : style == "clamp" || style == "none" ? Wrap::kClamp : Wrap::kRepeat;
  }

  void FinishColors() {
    const size_t triangles = mesh_.triangles.size();
    if (bare_ == triangles || !mesh_.no_color.empty()) {
      mesh_.colors.clear();
    } else if (bare_ > 0) {
      mesh_.warnings.push_back(
          {"PARTIAL_COLORS", absl::StrCat(bare_, " of ", triangles, " triangles have no color, and are white")});
    }
  }

  ZipArchive archive_;
  BadElements bad_;
  absl::flat_hash_map<std::string, Model> models_;
  absl::flat_hash_map<void*, std::unique_ptr<ThreeMfObject>> meshes_;  // keyed by node
  std::set<std::pair<std::string, void*>> warned_;                     // codes and nodes
  size_t bare_ = 0;                                                    // triangles without a color
  ThreeMfProperties properties_;
  size_t placed_ = 0;
  Mesh mesh_;
};

}  // namespace

absl::StatusOr<Mesh> Parse3mf(absl::string_view bytes, const ParseOptions& options) {
  auto archive = ZipArchive::Open(bytes, kMaxBytes);
  if (!archive.ok()) return archive.status();
  return Reader(*std::move(archive), options).Read();
}

}  // namespace latvox::client
