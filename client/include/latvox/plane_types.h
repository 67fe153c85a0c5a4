// A pixelization's request and answer, as plain values; see latvox/types.h, and Pixelize in
// proto/latvox/v1/voxelizer.proto.
//
// Frames: world coordinates are x, y in the polylines' units; lattice coordinates are the integers i, j, with
// world = origin + i*a + j*b.
#ifndef LATVOX_LATVOX_PLANE_TYPES_H_
#define LATVOX_LATVOX_PLANE_TYPES_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace latvox::client {

using Vec2d = std::array<double, 2>;   // a world position or vector: x, y
using Vec2i = std::array<int32_t, 2>;  // lattice coordinates: i, j

// The common plane lattices, in the protocol's order. Bases are given up to scale.
enum class NamedPlaneLattice {
  kSquare,     // (1,0) (0,1)
  kHexagonal,  // (1,0) (1/2,sqrt(3)/2)
};

// A common plane lattice: its value and its name.
struct NamedPlaneBasis {
  NamedPlaneLattice lattice;  // its value
  const char* name;           // in the protocol, in files and on the command line
};

// All of them, in the order of their values.
inline constexpr std::array kNamedPlaneLattices{
    NamedPlaneBasis{NamedPlaneLattice::kSquare, "square"},
    NamedPlaneBasis{NamedPlaneLattice::kHexagonal, "hexagonal"},
};

// The world vectors of one step in i and j.
struct PlaneBasis {
  Vec2d a{1, 0};  // of i
  Vec2d b{0, 1};  // of j
  bool operator==(const PlaneBasis&) const = default;
};

// One contour.
struct Polyline {
  std::vector<Vec2d> points;  // world
  bool closed = false;        // whether a segment leads from the last point back to the first
  bool operator==(const Polyline&) const = default;
};

// The ways to find pixels. All except kExact are for comparison.
enum class LineAlgorithm {
  kExact,        // the nearer ends of all lattice links that the polylines cross
  kBruteForce,   // every pixel within half a step of a segment
  kIncremental,  // one pixel for each lattice line that meets a segment
  kIbanez,       // steps from pixel to pixel
};

// The job. Give at most one of pixel_size and resolution (both: INVALID_ARGUMENT); a named lattice needs one.
struct PixelizeRequest {
  std::vector<Polyline> polylines;  // at least one
  std::variant<NamedPlaneLattice, PlaneBasis> lattice =
      NamedPlaneLattice::kSquare;      // a PlaneBasis is scaled to one of the next two
  std::optional<double> pixel_size;    // edge of a square with a Voronoi cell's area, world units
  std::optional<uint32_t> resolution;  // pixels along the longer side of the polylines' bounding box
  std::optional<Vec2d> origin;         // world position of lattice point 0; default: the polylines' low corner
  uint32_t separability = 0;           // k: 0 or 1
  bool minimal = true;                 // whether to remove pixels until none can leave
  LineAlgorithm algorithm = LineAlgorithm::kExact;  // the way to find the pixels
};

// World positions of lattice coordinates: world = origin + i*a + j*b.
struct PlaneTransform {
  PlaneBasis basis;       // scaled, world units
  Vec2d origin{};         // world position of lattice point 0
  double pixel_size = 0;  // edge of a square with a Voronoi cell's area, world units

  // Returns the center of a pixel.
  Vec2d ToWorld(const Vec2i& ij) const {
    return {origin[0] + ij[0] * basis.a[0] + ij[1] * basis.b[0], origin[1] + ij[0] * basis.a[1] + ij[1] * basis.b[1]};
  }
};

// The answer.
struct Pixelization {
  std::string request_id;       // in the server's log
  PlaneTransform grid;          // where lattice points are
  std::vector<Vec2i> pixels;    // in lexicographic order, each once
  uint64_t crossed_edges = 0;   // lattice links that the curve crosses
  uint64_t tunnels = 0;         // links among these without an end among the pixels; always counted
  uint64_t redundant = 0;       // pixels that could leave; always counted
  double snap_error_max = 0;    // the most that snapping moved a point, in each lattice coordinate, in pixels
  std::string lattice;          // "square", "hexagonal" or "basis"
  std::string algorithm;        // "exact", "brute-force", "incremental" or "ibanez"
  std::string version;          // of the server
  std::string digest;           // identifies the pixel set: 32 hexadecimal digits
  double pixelize_ms = 0;       // within the server
  uint64_t bytes_sent = 0;      // of messages as this client counted them
  uint64_t bytes_received = 0;  // likewise
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_PLANE_TYPES_H_
