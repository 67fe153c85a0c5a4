// The thesis's water test (section 5.1): discrete water poured into a volume shows whether a surface keeps it out.
#ifndef LATVOX_CORE_VERIFY_WATER_H_
#define LATVOX_CORE_VERIFY_WATER_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "core/brick/voxel_set.h"
#include "core/lattice/frame.h"

namespace latvox {

// The numbering of a volume's points.
enum class Numbering {
  kLattice,  // by lattice coordinates; a box in the world on a Cartesian lattice
  kBcc       // D x D x 2D, see bcc_indexing.h; a box in the world on BCC
};

// Lattice points with numbers (x, y, z) from 0 to size-1 on each axis, and a margin of two around them (figure 5.4).
// The water must be able to go around, and every voxel must have its neighbors.
struct Volume {
  Numbering numbering = Numbering::kLattice;
  Vec3i size;
  uint64_t points() const;  // D of eq. 5.1, without the margin
};
inline constexpr int32_t kVolumeMargin = 2;

enum class Label : uint8_t { kInside, kWater, kSurface };

// A volume after the water has come to rest. The points that it did not reach are inside.
class Flood {
 public:
  // Pours water in at the low corner of the padded volume. From each point it flows to all k-neighbors that are not in
  // `surface`. The thesis does so breadth first, point by point; this does it by rows of bits, with the same result.
  //   surface   voxels outside of the padded volume do not count
  //   frames    of N_k
  Flood(const Volume& volume, const VoxelSet& surface, const std::vector<Frame>& frames);

  // Label of a lattice point (ijk), or nullopt outside of the padded volume.
  std::optional<Label> At(const Vec3i& ijk) const;

  // Points of the padded volume.
  uint64_t inside() const { return inside_; }
  uint64_t water() const { return water_; }
  uint64_t surface() const { return surface_; }

  // Delta(V), eq. 5.1: the share of the volume's D points that lie inside. (The padding is water, or nothing is inside,
  // so D - Delta(S) - A is the same with and without it.)
  double DisplacedVolume() const;

 private:
  // The points with one x and y are a row of bits by z, in whole words; those beyond the volume are never set.
  struct Place {
    size_t word;
    uint64_t bit;
  };
  // nullopt outside of the padded volume.
  std::optional<Place> PlaceOf(const Vec3i& ijk) const;

  const Volume volume_;
  const Vec3i padded_;      // size with margins
  const size_t row_words_;  // row (x, y) begins at word (x * padded_[1] + y) * row_words_
  std::vector<uint64_t> surface_bits_, water_bits_;
  uint64_t inside_ = 0, water_ = 0, surface_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_VERIFY_WATER_H_
