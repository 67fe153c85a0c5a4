#include "client/mesh_files/draco_file.h"

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>

#include <array>
#include <cmath>
#include <exception>
#include <new>
#include <string>

#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/bad.h"

namespace latvox::client {
namespace {

// Returns the full intensity of a color, as Draco converts the numbers of an attribute.
double FullColor(const draco::PointAttribute& colors) {
  if (colors.normalized()) return 1;
  return colors.data_type() == draco::DT_UINT8 ? 255 : colors.data_type() == draco::DT_UINT16 ? 65535 : 1;
}

absl::StatusOr<DracoNumbers> ReadDracoNumbers(const draco::Mesh& decoded, uint32_t id) {
  const draco::PointAttribute* attribute = decoded.GetAttributeByUniqueId(id);
  if (attribute == nullptr || attribute->num_components() == 0) return Bad("has no attribute ", id);
  DracoNumbers numbers{static_cast<size_t>(attribute->num_components()), FullColor(*attribute)};
  for (uint32_t p = 0; p < decoded.num_points(); ++p) {
    const auto entry = attribute->mapped_index(draco::PointIndex(p));
    numbers.values.resize(numbers.values.size() + numbers.components);
    double* const out = &numbers.values[numbers.values.size() - numbers.components];
    if (entry.value() >= attribute->size() ||
        !attribute->ConvertValue<double>(entry, attribute->num_components(), out)) {
      return Bad("vertex ", p, " has no number of attribute ", id);
    }
  }
  return numbers;
}

// Reads colors as the server does when it takes the stream as it is.
void ReadColors(const draco::Mesh& decoded, Mesh& mesh) {
  const draco::PointAttribute* colors = decoded.GetNamedAttribute(draco::GeometryAttribute::COLOR);
  if (colors == nullptr) return;
  if (colors->num_components() < 3) {
    mesh.no_color = absl::StrCat("colors have ", colors->num_components(), " components, not 3 or more");
    return;
  }
  const auto numbers = ReadDracoNumbers(decoded, colors->unique_id());
  if (!numbers.ok()) {
    mesh.no_color = std::string(numbers.status().message());
    return;
  }
  for (size_t at = 0; at < numbers->values.size(); at += numbers->components) {
    std::array<float, 3> rgb;
    for (size_t n = 0; n < 3; ++n) rgb[n] = static_cast<float>(numbers->values[at + n] / numbers->full);
    mesh.colors.push_back(ToColor(rgb.data()));
  }
}

absl::StatusOr<Mesh> FromDraco(const draco::Mesh& decoded, const DracoIds& ids, std::vector<DracoNumbers>* numbers) {
  const draco::PointAttribute* positions = ids.positions
                                               ? decoded.GetAttributeByUniqueId(*ids.positions)
                                               : decoded.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  if (positions == nullptr || positions->num_components() != 3) return Bad("has no positions of three numbers");
  Mesh mesh;
  for (uint32_t p = 0; p < decoded.num_points(); ++p) {
    const auto entry = positions->mapped_index(draco::PointIndex(p));
    Vec3d position{};
    if (entry.value() >= positions->size() || !positions->ConvertValue<double>(entry, 3, position.data())) {
      return Bad("vertex ", p, " has no position");
    }
    for (const double coordinate : position) {
      if (!std::isfinite(coordinate)) return Bad("vertex ", p, " is not finite (", coordinate, ")");
    }
    mesh.positions.push_back(position);
  }
  for (uint32_t f = 0; f < decoded.num_faces(); ++f) {
    auto& triangle = mesh.triangles.emplace_back();
    for (size_t n = 0; n < 3; ++n) {
      triangle[n] = decoded.face(draco::FaceIndex(f))[n].value();
      if (triangle[n] >= decoded.num_points()) {
        return Bad("vertex index ", triangle[n], " of face ", f, " is not within the ", decoded.num_points(),
                   " vertices");
      }
    }
  }
  if (!ids.positions) ReadColors(decoded, mesh);
  for (const uint32_t id : ids.numbers) {
    auto read = ReadDracoNumbers(decoded, id);
    if (!read.ok()) return read.status();
    numbers->push_back(*std::move(read));
  }
  return mesh;
}

}  // namespace

absl::StatusOr<Mesh> ParseDraco(absl::string_view bytes, const DracoIds& ids, std::vector<DracoNumbers>* numbers) try {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) return Bad("is not a Draco mesh (", decoded.status().error_msg_string(), ")");
  return FromDraco(*decoded.value(), ids, numbers);
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("not enough memory to decode the mesh");
} catch (const std::exception& error) {
  return Bad("cannot be decoded (", error.what(), ")");
}

}  // namespace latvox::client
