// What a pixelization asks for and what it answers, as plain values; see client/types.h, and Pixelize in
// proto/latvox/v1/voxelizer.proto.
//
// Frames: world coordinates are x, y in the polylines' units; lattice coordinates are the integers i, j, with
// world = origin + i*a + j*b.
#ifndef LATVOX_CLIENT_PLANE_TYPES_H_
#define LATVOX_CLIENT_PLANE_TYPES_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace latvox::client {

using Vec2d = std::array<double, 2>;
using Vec2i = std::array<int32_t, 2>;

enum class NamedPlaneLattice { kSquare, kHexagonal };

// The world vectors of one step in i and j.
struct PlaneBasis {
  Vec2d a{1, 0}, b{0, 1};
  bool operator==(const PlaneBasis&) const = default;
};

// One contour.
struct Polyline {
  std::vector<Vec2d> points;  // world
  bool closed = false;        // whether a segment leads from the last point back to the first
  bool operator==(const Polyline&) const = default;
};

// How to find the pixels. All but kExact are there to compare with.
enum class LineAlgorithm { kExact, kBruteForce, kIncremental, kIbanez };

// What to compute. At most one of pixel_size and resolution; a named lattice needs one of them.
struct PixelizeRequest {
  std::vector<Polyline> polylines;
  std::variant<NamedPlaneLattice, PlaneBasis> lattice = NamedPlaneLattice::kSquare;
  std::optional<double> pixel_size;    // edge of a square with a Voronoi cell's area, world units
  std::optional<uint32_t> resolution;  // pixels along the longer side of the polylines' bounding box
  std::optional<Vec2d> origin;         // world position of lattice point 0; default: the polylines' low corner
  uint32_t separability = 0;           // k: 0 or 1
  bool minimal = true;
  LineAlgorithm algorithm = LineAlgorithm::kExact;
};

// World positions of lattice coordinates: world = origin + i*a + j*b.
struct PlaneTransform {
  PlaneBasis basis;
  Vec2d origin{};
  double pixel_size = 0;

  Vec2d ToWorld(const Vec2i& ij) const {
    return {origin[0] + ij[0] * basis.a[0] + ij[1] * basis.b[0], origin[1] + ij[0] * basis.a[1] + ij[1] * basis.b[1]};
  }
};

// The answer.
struct Pixelization {
  std::string request_id;
  PlaneTransform grid;
  std::vector<Vec2i> pixels;  // in lexicographic order, each once
  uint64_t crossed_edges = 0, tunnels = 0, redundant = 0;
  double snap_error_max = 0;
  std::string lattice;             // "square", "hexagonal" or "basis"
  std::string algorithm, version;  // of the server
  std::string digest;              // 32 hexadecimal digits
  double pixelize_ms = 0;          // within the server
  // Bytes of messages as this client counted them.
  uint64_t bytes_sent = 0, bytes_received = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_PLANE_TYPES_H_
