#include "client/mesh_files/obj_file.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/mtl_file.h"
#include "client/mesh_files/obj_statements.h"
#include "client/mesh_files/obj_texture.h"
#include "client/mesh_files/obj_vertices.h"
#include "client/mesh_files/polygon.h"
#include "client/mesh_files/triangle_colors.h"

// No assimp: its decimal parser misses the nearest number for about one number in a hundred. It gives each face corner
// its own vertex. Its errors name neither line nor index. Exact voxels of the most common text format should not depend
// on that.
namespace latvox::client {
namespace {

// Keywords without geometry of their own. Those of the last rows belong to a curve or a surface.
constexpr absl::string_view kSettings[] = {"vn",        "s",      "mg",    "usemap",   "maplib",   "shadow_obj",
                                           "trace_obj", "lod",    "bevel", "c_interp", "d_interp", "ctech",
                                           "stech",     "cstype", "deg",   "bmat",     "step",     "parm",
                                           "trim",      "hole",   "scrv",  "sp",       "con",      "end"};

// Keywords of elements that are not polygons.
constexpr absl::string_view kElements[] = {"l",   "p",   "curv", "curv2", "surf", "vp", "call",
                                           "csh", "bsp", "bzp",  "cdc",   "cdp",  "res"};

template <size_t kSize>
bool IsOneOf(absl::string_view word, const absl::string_view (&words)[kSize]) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

std::string Name(absl::string_view rest) { return std::string(absl::StripAsciiWhitespace(rest)); }

// Reads the index of a corner, such as "7" or "7/1/3", if it is that of a finite position. Returns false for all
// others, which ParseCorner reads or refuses.
bool ParsePlainCorner(absl::string_view word, const std::vector<Vec3d>& positions, uint32_t& vertex) {
  constexpr size_t kMostDigits = 9;
  uint32_t index = 0;
  size_t n = 0;
  for (; n < word.size() && n <= kMostDigits && word[n] >= '0' && word[n] <= '9'; ++n) {
    index = 10 * index + static_cast<uint32_t>(word[n] - '0');
  }
  const bool is_plain = n <= kMostDigits && (n == word.size() || word[n] == '/');
  if (!is_plain || index == 0 || index > positions.size() || !IsFinite(positions[index - 1])) return false;
  vertex = index - 1;
  return true;
}

// Reads "7", "7/1", "7//3" or "-2": the index of a position, counted from 1, or backwards from the last vertex before
// this line.
absl::StatusOr<uint32_t> ParseCorner(absl::string_view word, size_t line, size_t vertices_before,
                                     const std::vector<Vec3d>& positions) {
  const absl::string_view number = word.substr(0, word.find('/'));
  int64_t index = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
  if (error == std::errc::result_out_of_range) {
    return LineError(line, "vertex index ", number, " of a face exceeds the file's ", positions.size(), " vertices");
  }
  if (error != std::errc() || end != number.data() + number.size()) {
    return LineError(line, "vertex index \"", word, "\" of a face is not a number");
  }
  const int64_t from_zero = index > 0 ? index - 1 : static_cast<int64_t>(vertices_before) + index;
  if (index == 0 || from_zero < 0 || from_zero >= static_cast<int64_t>(positions.size())) {
    return LineError(line, "vertex index ", index, " of a face is not within the file's ", positions.size(),
                     " vertices");
  }
  const Vec3d& position = positions[static_cast<size_t>(from_zero)];
  if (IsFinite(position)) return static_cast<uint32_t>(from_zero);
  return LineError(line, "vertex ", from_zero + 1, " of a face is not finite (", absl::StrJoin(position, " "), ")");
}

// Elements that are not read.
class Skipped {
 public:
  void Add(absl::string_view keyword, size_t line) {
    if (first_line_ == 0) first_line_ = line;
    if (IsOneOf(keyword, kElements)) {
      ++counts_[std::string(keyword)];
    } else if (unknown_++ == 0) {
      first_unknown_ = absl::StrCat("the first: \"", keyword.substr(0, 20), "\" in line ", line);
    }
  }

  void Report(Mesh& mesh) const {
    std::vector<std::string> kinds;
    for (const auto& [keyword, count] : counts_) kinds.push_back(absl::StrCat(count, " \"", keyword, "\""));
    if (unknown_ > 0) kinds.push_back(absl::StrCat(unknown_, " of unknown kinds (", first_unknown_, ")"));
    if (kinds.empty()) return;
    for (const auto& [keyword, count] : counts_) mesh.skipped += count;
    mesh.skipped += unknown_;
    mesh.warnings.push_back(
        {"SKIPPED_ELEMENTS",
         absl::StrCat(mesh.skipped, " elements are no polygons, and are left out: ", absl::StrJoin(kinds, ", ")),
         NameOfLine(first_line_)});
  }

 private:
  std::map<std::string, uint64_t> counts_;  // of the known keywords; a continued statement does not stay
  uint64_t unknown_ = 0;
  std::string first_unknown_;
  size_t first_line_ = 0;
};

bool HasObjects(absl::string_view text) {
  ObjStatements statements(text);
  for (absl::string_view rest; statements.Next(rest);) {
    if (TakeWord(rest) == "o") return true;
  }
  return false;
}

// Reads everything but vertices.
class Faces {
 public:
  Faces(absl::string_view text, const ParseOptions& options, BadElements& bad, Mesh& mesh)
      : text_(text), bad_(bad), mesh_(mesh) {
    if (options.base_colors) points_.emplace(text);
  }

  absl::Status Read(absl::string_view statement, size_t line) {
    absl::string_view rest = statement;
    const absl::string_view keyword = TakeWord(rest);
    if (keyword.empty() || keyword[0] == '#') return absl::OkStatus();
    if (keyword == "v") {
      ++vertices_before_;
    } else if (keyword == "vt") {
      if (points_) points_->Pass();
    } else if (keyword == "f" || keyword == "fo") {  // "fo" in the first versions of the format
      const absl::Status status = ReadFace(rest, line);
      return status.ok() ? status : bad_.Add(status, NameOfLine(line));
    } else if (keyword == "o" || keyword == "g" || keyword == "usemtl") {
      BeginGroup(keyword[0], Name(rest));
    } else if (keyword == "mtllib") {
      libraries_.emplace_back(Name(rest), line);
    } else if (!IsOneOf(keyword, kSettings)) {
      skipped_.Add(keyword, line);
    }
    return absl::OkStatus();
  }

  absl::Status Finish(const std::filesystem::path& folder) {
    mesh_.materials = static_cast<uint32_t>(materials_.size());
    skipped_.Report(mesh_);
    MtlMaterials known;
    for (const auto& [names, line] : libraries_) ReadMaterials(names, line, folder, known, mesh_.warnings);
    const bool has_textures = points_ && !known.textures.empty();
    if (mesh_.colors.empty() && (has_textures || !known.colors.empty())) ColorByMaterial(known, has_textures);
    if (points_) return ApplyTextures(known, NamesOfMaterials(), bad_, mesh_);
    for (const auto& [name, texture] : known.textures) WarnOfTexture(name);
    return absl::OkStatus();
  }

 private:
  absl::Status ReadFace(absl::string_view words, size_t line) {
    polygon_.clear();
    places_.clear();
    for (absl::string_view word = TakeWord(words); !word.empty() && word[0] != '#'; word = TakeWord(words)) {
      uint32_t vertex = 0;
      if (!ParsePlainCorner(word, mesh_.positions, vertex)) {
        const auto corner = ParseCorner(word, line, vertices_before_, mesh_.positions);
        if (!corner.ok()) return corner.status();
        vertex = *corner;
      }
      polygon_.push_back(vertex);
      if (!points_) continue;
      const auto place = points_->Of(word, line);
      if (!place.ok()) return place.status();
      places_.push_back(*place);
    }
    if (polygon_.size() < 3) return LineError(line, "a face has ", polygon_.size(), " corners, not 3 or more");
    if (points_) {
      TriangulateWithPlaces(polygon_, places_, mesh_);
    } else {
      Triangulate(polygon_, mesh_.positions, mesh_.triangles);
    }
    return absl::OkStatus();
  }

  std::vector<std::string> NamesOfMaterials() const {
    std::vector<std::string> names(materials_.size());
    for (const auto& [name, number] : materials_) names[number] = name;
    return names;
  }

  void WarnOfTexture(const std::string& material) {
    mesh_.warnings.push_back(
        {"IGNORED_TEXTURE",
         absl::StrCat("material \"", material, "\" has a texture, which is not read: nobody asked for colors"),
         absl::StrCat("material ", material)});
  }

  // `kind` is the first letter of the keyword.
  void BeginGroup(char kind, const std::string& name) {
    if (kind == 'g') {
      if (!has_objects_) has_objects_ = HasObjects(text_);
      if (*has_objects_ || name == group_) return;
      group_ = name;
    }
    if (kind == 'u') {
      const auto number = static_cast<uint32_t>(materials_.size());
      stretch_.material = materials_.try_emplace(name, number).first->second;
      SetName(*stretch_.material, name, mesh_.material_names);
    } else {
      stretch_.part = NextPart(mesh_);
      SetName(stretch_.part, name, mesh_.part_names);
    }
    BeginStretch(stretch_.part, stretch_.material, mesh_);
  }

  // Textures without Kd are on white.
  void ColorByMaterial(const MtlMaterials& known, bool has_textures) {
    std::vector<std::optional<Color>> of_material(materials_.size());
    for (const auto& [name, number] : materials_) {
      if (has_textures && known.textures.contains(name)) of_material[number] = Color{255, 255, 255};
      if (const auto found = known.colors.find(name); found != known.colors.end()) of_material[number] = found->second;
    }
    std::vector<std::optional<Color>> colors;
    colors.reserve(mesh_.triangles.size());
    for (size_t s = 0; s <= mesh_.stretches.size(); ++s) {
      const size_t end = s < mesh_.stretches.size() ? mesh_.stretches[s].first : mesh_.triangles.size();
      const auto material = s > 0 ? mesh_.stretches[s - 1].material : std::nullopt;
      colors.resize(end, material ? of_material[*material] : std::nullopt);
    }
    ColorTriangles(colors, mesh_);
  }

  absl::string_view text_;
  BadElements& bad_;
  Mesh& mesh_;
  size_t vertices_before_ = 0;
  std::vector<uint32_t> polygon_;
  std::vector<ImagePoint> places_;          // of its corners
  std::optional<ObjTexturePoints> points_;  // if base colors are read
  absl::flat_hash_map<std::string, uint32_t> materials_;
  std::vector<std::pair<std::string, size_t>> libraries_;  // with their lines
  std::optional<bool> has_objects_;                        // known from the first group on
  std::optional<std::string> group_;
  Stretch stretch_;
  Skipped skipped_;
};

}  // namespace

// Two passes: faces may refer to later vertices, and cutting a polygon needs the positions of its corners.
absl::StatusOr<Mesh> ParseObj(absl::string_view text, const ParseOptions& options,
                              const std::filesystem::path& folder) {
  Mesh mesh;
  BadElements bad(options);
  if (auto status = ReadObjVertices(text, bad, mesh); !status.ok()) return status;
  Faces faces(text, options, bad, mesh);
  ObjStatements statements(text);
  for (absl::string_view statement; statements.Next(statement);) {
    if (auto status = faces.Read(statement, statements.line()); !status.ok()) return status;
  }
  if (auto status = faces.Finish(folder); !status.ok()) return status;
  bad.Report(mesh);
  RemoveNotFinite(mesh);
  return mesh;
}

}  // namespace latvox::client
