#include "client/mesh_files/off_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/number_text.h"
#include "client/mesh_files/obj_statements.h"
#include "client/mesh_files/off_header.h"
#include "client/mesh_files/off_mesh.h"
#include "client/mesh_files/ply_body.h"

// No assimp: it reads neither colors nor binary files, and takes a number that is missing for 0.
namespace latvox::client {
namespace {

using OffWords = std::span<const absl::string_view>;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// Elements with something that is not read.
struct IgnoredElements {
  uint64_t count = 0, first = 0;

  void Add(uint64_t element) {
    if (count++ == 0) first = element;
  }
};

void WarnOfMaps(const IgnoredElements& faces, OffMesh& mesh) {
  if (faces.count == 0) return;
  mesh.Warn({"IGNORED_COLOR",
             absl::StrCat(faces.count, " faces name their color by an index into a map, which the file has not; ",
                          "the first: face ", faces.first),
             absl::StrCat("face ", faces.first)});
}

// Returns red, green and blue of 3 or 4 words. A word that is no number becomes NaN, which no color has.
OffColor ColorOf(OffWords words) {
  OffColor color{.is_integers = true};
  for (size_t n = 0; n < color.rgb.size(); ++n) {
    if (!ParseDouble(words[n], color.rgb[n])) color.rgb[n] = kNoNumber;
    color.is_integers = color.is_integers && words[n].find_first_of(".eE") == absl::string_view::npos;
  }
  return color;
}

class OffTextReader {
 public:
  OffTextReader(const OffHeader& header, OffLines& lines, OffMesh& mesh)
      : header_(header), lines_(lines), mesh_(mesh) {}

  absl::Status Read() {
    for (uint64_t n = 0; n < header_.vertices; ++n) {
      if (!lines_.Next(words_)) return Bad("ends at vertex ", n, " of ", header_.vertices);
      if (auto status = ReadVertex(n); !status.ok()) {
        if (auto error = mesh_.AddBad(status, NameOfLine(lines_.number())); !error.ok()) return error;
        mesh_.AddVertex({kNoNumber, kNoNumber, kNoNumber}, std::nullopt);
      }
    }
    for (uint64_t n = 0; n < header_.faces; ++n) {
      if (!lines_.Next(words_)) return Bad("ends at face ", n, " of ", header_.faces);
      if (auto status = ReadFace(n); !status.ok()) {
        if (auto error = mesh_.AddBad(status, NameOfLine(lines_.number())); !error.ok()) return error;
      }
    }
    Report();
    return absl::OkStatus();
  }

 private:
  template <class... Parts>
  absl::Status Error(const Parts&... parts) const {
    return LineError(lines_.number(), parts...);
  }

  absl::Status ReadVertex(uint64_t n) {
    const size_t color = header_.has_normals ? 6 : 3;  // the first word of it
    const size_t known = color + (header_.has_texture ? 2 : 0);
    const size_t of_color = words_.size() - std::min(words_.size(), known);
    if (words_.size() < known) return Error("vertex ", n, " has ", words_.size(), " numbers, not ", known);
    if (header_.has_colors && of_color != 3 && of_color != 4) {
      return Error("vertex ", n, " has a color of ", of_color, " numbers, not 3 or 4");
    }
    Vec3d position;
    for (size_t axis = 0; axis < 3; ++axis) {
      if (ParseDouble(words_[axis], position[axis])) continue;
      return Error("coordinate \"", words_[axis].substr(0, 20), "\" of vertex ", n, " is not a number");
    }
    if (!header_.has_colors && of_color > 0) longer_.Add(lines_.number());
    mesh_.AddVertex(position,
                    header_.has_colors ? std::optional(ColorOf(OffWords(words_).subspan(color))) : std::nullopt);
    return absl::OkStatus();
  }

  absl::Status ReadFace(uint64_t n) {
    double corners = 0;
    if (!ParseDouble(words_[0], corners) || corners < 0 || corners != std::floor(corners)) {
      return Error("\"", words_[0].substr(0, 20), "\" is not the number of corners of face ", n);
    }
    const size_t given = words_.size() - 1;
    if (corners > static_cast<double>(given)) return Error("face ", n, " has ", given, " corners, not ", corners);
    indices_.assign(static_cast<size_t>(corners), 0);
    for (size_t c = 0; c < indices_.size(); ++c) {
      if (ParseDouble(words_[c + 1], indices_[c])) continue;
      return Error("vertex index \"", words_[c + 1].substr(0, 20), "\" of face ", n, " is not a number");
    }
    const auto color = ReadFaceColor(OffWords(words_).subspan(1 + indices_.size()), n);
    const absl::Status status = mesh_.AddFace(indices_, color, n);
    return status.ok() ? status : Error(status.message());
  }

  std::optional<OffColor> ReadFaceColor(OffWords words, uint64_t n) {
    if (words.size() == 3 || words.size() == 4) return ColorOf(words);
    if (words.size() == 1) {
      maps_.Add(n);
    } else if (!words.empty()) {
      longer_.Add(lines_.number());
    }
    return std::nullopt;
  }

  void Report() {
    if (longer_.count > 0) {
      mesh_.Warn({"EXTRA_VALUES",
                  absl::StrCat(longer_.count, " lines have more values than the header tells, which are ignored; ",
                               "the first: line ", longer_.first),
                  NameOfLine(longer_.first)});
    }
    WarnOfMaps(maps_, mesh_);
    if (!lines_.Next(words_)) return;
    mesh_.Warn({"TRAILING_DATA",
                absl::StrCat("lines after the last face are ignored; the first: line ", lines_.number()),
                NameOfLine(lines_.number())});
  }

  const OffHeader& header_;
  OffLines& lines_;
  OffMesh& mesh_;
  std::vector<absl::string_view> words_;  // of the line
  std::vector<double> indices_;
  IgnoredElements longer_;  // lines
  IgnoredElements maps_;    // faces
};

// Reads after the line OFF BINARY: the counts of vertices, faces and edges; for each vertex 3 numbers, then 3 of its
// normal, 4 of its color, 2 of its texture coordinates; for each face its corners and its color, each with their count.
class OffBinaryReader {
 public:
  OffBinaryReader(const OffHeader& header, absl::string_view bytes, OffMesh& mesh)
      : header_(header), body_(bytes, PlyFormat::kBigEndian, 0), mesh_(mesh) {}

  absl::Status Read() {
    const int64_t vertices = Integer(), faces = Integer();
    Integer();  // edges
    if (!body_.ok() || vertices < 0 || faces < 0) {
      return Bad("the numbers of vertices and faces, ", vertices, " and ", faces, ", are damaged or cut short");
    }
    for (int64_t n = 0; n < vertices; ++n) {
      ReadVertex();
      if (!body_.ok()) return Bad("ends at vertex ", n, " of ", vertices);
    }
    for (int64_t n = 0; n < faces; ++n) {
      const absl::Status status = ReadFace(static_cast<uint64_t>(n));
      if (!body_.ok()) return Bad("ends at face ", n, " of ", faces);
      if (!status.ok()) return status;
    }
    WarnOfMaps(maps_, mesh_);
    if (body_.HasMore()) mesh_.Warn({"TRAILING_DATA", "data after the last face are ignored", ""});
    return absl::OkStatus();
  }

 private:
  int64_t Integer() { return static_cast<int64_t>(body_.ReadNumber(PlyScalar::kInt32)); }
  double Float() { return body_.ReadNumber(PlyScalar::kFloat32); }

  // Reads a color, and skips what follows it.
  OffColor ReadColor(int64_t components) {
    OffColor color;
    for (int64_t n = 0; n < components && body_.ok(); ++n) {
      const double number = Float();
      if (n < 3) color.rgb[static_cast<size_t>(n)] = number;
    }
    return color;
  }

  void ReadVertex() {
    Vec3d position;
    for (double& coordinate : position) coordinate = Float();
    for (int n = header_.has_normals ? 3 : 0; n > 0; --n) Float();
    const auto color = header_.has_colors ? std::optional(ReadColor(4)) : std::nullopt;
    for (int n = header_.has_texture ? 2 : 0; n > 0; --n) Float();
    if (body_.ok()) mesh_.AddVertex(position, color);
  }

  absl::Status ReadFace(uint64_t n) {
    indices_.clear();
    const int64_t corners = Integer();
    if (corners < 0) return Bad("face ", n, " has ", corners, " corners");
    for (int64_t c = 0; c < corners && body_.ok(); ++c) indices_.push_back(static_cast<double>(Integer()));
    const int64_t components = Integer();
    if (components != 0 && components != 1 && components != 3 && components != 4) {
      return Bad("face ", n, " has a color of ", components, " numbers, not 0, 1, 3 or 4");
    }
    const OffColor color = ReadColor(components);
    if (!body_.ok()) return absl::OkStatus();  // the caller tells
    if (components == 1) maps_.Add(n);
    const absl::Status status = mesh_.AddFace(indices_, components >= 3 ? std::optional(color) : std::nullopt, n);
    return status.ok() ? status : mesh_.AddBad(status, absl::StrCat("face ", n));
  }

  const OffHeader& header_;
  PlyBody body_;
  OffMesh& mesh_;
  std::vector<double> indices_;
  IgnoredElements maps_;  // faces
};

}  // namespace

// No declared count is trusted with an allocation: vectors grow with the bytes that exist.
absl::StatusOr<Mesh> ParseOff(absl::string_view bytes, const ParseOptions& options) {
  OffLines lines(bytes);
  const auto header = ReadOffHeader(lines);
  if (!header.ok()) return header.status();
  OffMesh mesh(options);
  const absl::Status status = header->is_binary ? OffBinaryReader(*header, lines.rest(), mesh).Read()
                                                : OffTextReader(*header, lines, mesh).Read();
  if (!status.ok()) return status;
  return std::move(mesh).Finish();
}

}  // namespace latvox::client
