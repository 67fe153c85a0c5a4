// Pictures of voxel sets.
#ifndef LATVOX_CLIENT_OUTPUT_PICTURE_H_
#define LATVOX_CLIENT_OUTPUT_PICTURE_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/types.h"

namespace latvox::client {

// An orthographic view, from the front, the right and above (y is up), in which every voxel shows as its Voronoi cell:
// cubes, truncated octahedra, rhombic dodecahedra, prisms. Voxels are drawn as they come, so that memory is the
// picture's own, about 60 MiB, whatever their number. Not thread-safe.
class Picture {
 public:
  static constexpr int kSide = 1024;  // pixels

  // Shows `low` to `high`, world coordinates.
  Picture(const GridTransform& grid, const Vec3d& low, const Vec3d& high);

  void Draw(const Brick& brick);

  // The picture as a PNG file's bytes. Errors: INTERNAL (libpng).
  absl::StatusOr<std::string> ToPng() const;

 private:
  static constexpr int kSamples = 2;  // per pixel and axis
  static constexpr int kWide = kSide * kSamples;

  // A sample of the voxel's cell, relative to the sample that the voxel's centre falls on.
  struct Stamp {
    int32_t dx, dy;
    float depth;      // towards the viewer, in samples
    uint16_t normal;  // into normals_
  };

  using Rgb = std::array<float, 3>;

  Vec3d ToView(const Vec3d& world) const;
  void Frame(const Vec3d& low, const Vec3d& high);
  void MakeStamps();
  void DrawVoxel(const Vec3i& ijk);
  std::vector<float> SmoothDepth() const;
  Rgb Shade(const std::vector<float>& smooth, int x, int y) const;

  GridTransform grid_;
  Vec3d center_{};
  double scale_ = 1;          // samples per world unit
  double voxel_samples_ = 1;  // voxel_size in samples
  std::vector<Stamp> stamps_;
  std::vector<std::array<float, 3>> normals_;  // of the cell's faces, view frame
  std::vector<float> depth_;                   // kWide * kWide, rows from the top; kNothing where no voxel is
  std::vector<uint16_t> normal_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_OUTPUT_PICTURE_H_
