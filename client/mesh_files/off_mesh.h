// The mesh of an OFF file, as its elements are read.
#ifndef LATVOX_CLIENT_MESH_FILES_OFF_MESH_H_
#define LATVOX_CLIENT_MESH_FILES_OFF_MESH_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/color_numbers.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client {

struct OffColor {
  ColorNumbers::Numbers rgb{};
  bool is_integers = false;  // written without a point or an exponent
};

// The colors of vertices or of triangles. In the format, integers are 0 to 255, and other numbers 0 to 1. Not all
// programs heed that, so each of both kinds has the scale of its own numbers (ColorNumbers).
class OffColors {
 public:
  // Adds the color of the next element.
  void Add(const std::optional<OffColor>& color);

  size_t size() const { return kinds_.size(); }
  bool empty() const { return kinds_.empty(); }

  // Returns the colors as bytes. Errors: as ColorNumbers::ToBytes.
  absl::StatusOr<std::vector<std::optional<Color>>> ToBytes(const std::string& element) const;

 private:
  std::vector<std::optional<bool>> kinds_;  // whether the color is integers
  std::array<ColorNumbers, 2> numbers_;     // those that are not, and those that are; others are missing
};

class OffMesh {
 public:
  explicit OffMesh(const ParseOptions& options) : bad_(options) {}

  void AddVertex(const Vec3d& position, const std::optional<OffColor>& color);

  // Adds face n. Errors: as AppendFace of indexed_faces.h.
  absl::Status AddFace(const std::vector<double>& indices, const std::optional<OffColor>& color, uint64_t n);

  // Returns the error, or OK if the element is to be left out.
  absl::Status AddBad(const absl::Status& error, const std::string& element) { return bad_.Add(error, element); }

  void Warn(Warning warning) { mesh_.warnings.push_back(std::move(warning)); }

  // Returns the mesh. Colors of vertices count, if faces have colors, too.
  Mesh Finish() &&;

 private:
  void TakeVertexColors();
  void TakeFaceColors();

  BadElements bad_;
  Mesh mesh_;
  OffColors vertex_colors_;
  OffColors triangle_colors_;  // none, until a face has one
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_OFF_MESH_H_
