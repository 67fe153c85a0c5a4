// A narrow band: the lattice points near a surface.
#ifndef LATVOX_CORE_REQUEST_BAND_H_
#define LATVOX_CORE_REQUEST_BAND_H_

#include <cstdint>

#include "core/lattice/lattice.h"

namespace latvox {

// The lattice points whose distance to the snapped surface is at most a width (a closed ball).
struct Band {
  double width = 0;        // finite, at least 1/8192 of a voxel size
  bool in_voxels = false;  // width counts voxel sizes; otherwise world units
};

// The largest reach of a band along each lattice axis, in voxels.
inline constexpr int32_t kMaxBandReach = 256;

// In world units.
inline double WidthOf(const Band& band, const Lattice& lattice) {
  return band.in_voxels ? band.width * lattice.voxel_size() : band.width;
}

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_BAND_H_
