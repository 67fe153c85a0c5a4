// The plane's pipeline: polylines -> lattice coordinates -> pixels, with their validation.
#ifndef LATVOX_CORE_PLANE_PIXELIZE_H_
#define LATVOX_CORE_PLANE_PIXELIZE_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop_signal.h"
#include "core/lattice/grid.h"
#include "core/plane/polyline.h"

namespace latvox {

// How finely to sample: nothing (the lattice as it is), a pixel size, or pixels along the longer side of the bounds.
struct PlaneSampling {
  std::optional<double> pixel_size = std::nullopt;  // world units, finite, > 0
  std::optional<uint32_t> resolution =
      std::nullopt;  // 2 .. kMaxPlaneResolution; pixel_size = longer side / (resolution - 1)
};

inline constexpr uint32_t kMaxPlaneResolution = 65536;

// The grid for polylines with these bounds. Without an origin, pixel 0 is the bounds' low corner.
// Errors: INVALID_ARGUMENT naming field, value and limit.
absl::StatusOr<PlaneGrid> ResolvePlaneGrid(const PlaneLattice& lattice, const PlaneSampling& sampling,
                                           const std::optional<Vec2d>& origin, const PlaneBounds& bounds);

enum class LineAlgorithm {
  kCrossing,     // the nearer ends of all crossed links; exact for any polylines
  kBruteForce,   // thesis sections 3.1, 4.2
  kIncremental,  // thesis sections 4.3, 4.4; moves every point to its nearest pixel first (section 4.6)
  kIbanez,       // thesis section 4.6; moves points likewise
};

struct PixelizeOptions {
  int separability = 0;  // k: 0 or 1
  bool minimal =
      true;  // thin to k-minimality; pixels that cover no crossed link, such as that of a single point, leave too
  LineAlgorithm algorithm = LineAlgorithm::kCrossing;
};

// Pixels that one brute-force call may test.
inline constexpr uint64_t kMaxBruteForcePixels = uint64_t{1} << 30;

// The last three are exact, and refer to the curve that the algorithm digitizes: the polylines as snapped to
// 1/kLatticeUnit of a pixel, or with their points moved to pixels.
struct PixelizeResult {
  std::vector<Vec2i> pixels;   // ij, sorted, without duplicates
  uint64_t crossed_links = 0;  // links that the curve crosses, each once
  uint64_t tunnels = 0;        // of these, without an end among the pixels; never any
  uint64_t redundant = 0;      // pixels that could leave, one at a time, without a tunnel; none if minimal
};

// Digitizes polylines: k-separating, and k-minimal on request. The result is a function of the arguments alone: not of
// the order, direction or repetition of polylines. Errors: INVALID_ARGUMENT naming field, value and limit: polylines
// (see CheckPolylines), extent, position, separability, algorithm (its cost). CANCELLED, soon, once stopped. Memory: in
// proportion to the crossed links, and to the pixels before thinning.
absl::StatusOr<PixelizeResult> Pixelize(const std::vector<Polyline>& polylines, const PlaneGrid& grid,
                                        const PixelizeOptions& options, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_PLANE_PIXELIZE_H_
