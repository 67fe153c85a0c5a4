// Attributes of voxels, compared with rational distances to all triangles.
#include "core/attributes/attributes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <span>
#include <string>

#include "core/band/metric.h"
#include "core/digitize/crossing.h"
#include "core/snap/snap.h"
#include "core/voxelizer/estimate.h"
#include "tests/unit/core/distance.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/sphere.h"

namespace latvox {
namespace {

using testing::HasSubstr;
using Carried = std::map<Vec3i, std::vector<uint32_t>>;

Carried CarriedBy(const Result& result, size_t count) {
  Carried carried;
  for (const TileBricks& tile : result.tiles) {
    EXPECT_EQ(tile.attributes.size(), tile.voxels * count);
    auto next = tile.attributes.begin();
    for (const Brick& brick : tile.bricks) {
      for (int32_t bit = 0; bit < 512; ++bit) {
        if (!(brick.mask[static_cast<size_t>(bit >> 6)] >> (bit & 63) & 1)) continue;
        const auto end = next + static_cast<std::ptrdiff_t>(count);
        carried[brick.brick_ijk * kBrickSide + Vec3i{bit >> 6, bit >> 3 & 7, bit & 7}] = {next, end};
        next = end;
      }
    }
  }
  return carried;
}

// The expected attributes of a voxel, and whether more than one value was the nearest.
struct Answer {
  std::vector<uint32_t> values;
  bool tied = false;
};

FieldList FirstFields(size_t count) {
  FieldList fields;
  for (const FieldFacts& row : std::span(kFields).first(count)) fields.Add(row.field);
  return fields;
}

class Oracle {
 public:
  Oracle(const TriangleMesh& mesh, const Lattice& lattice, uint32_t count)
      : g_(MakeMetric(lattice).value().g),
        mesh_(Snap(mesh, lattice, {0, 0, 0}, {2, 2, 2}).value()),
        attributes_(mesh.attributes),
        count_(count) {
    for (const auto& [a, b, c] : mesh_.triangles) {
      longest_.push_back(std::max(Distance(At(a), At(b)), Distance(At(a), At(c))));
    }
  }

  Answer At(const Vec3i& ijk) const {
    const Vec3i point = (ijk - mesh_.base_ijk) * kLatticeUnit;
    Rational nearest = -1, nearest_corner = -1;
    Answer answer;
    double least = std::numeric_limits<double>::infinity();  // of distances to first corners
    for (const auto& vertices : mesh_.triangles) least = std::min(least, Distance(point, At(vertices[0])));
    for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& vertices = mesh_.triangles[t];
      if (Distance(point, At(vertices[0])) - longest_[t] > 1.001 * least) continue;  // only saves time
      const Triangle triangle{At(vertices[0]), At(vertices[1]), At(vertices[2])};
      const Rational square = SquareTo(g_, point, triangle);
      if (nearest >= 0 && square > nearest) continue;
      if (nearest < 0 || square < nearest) nearest_corner = -1;
      nearest = square;
      for (const uint32_t vertex : vertices) {
        const RationalVec d = Difference(point, At(vertex));
        const Rational to_corner = Inner(g_, d, d);
        if (nearest_corner >= 0 && to_corner > nearest_corner) continue;
        const uint32_t* const values = &attributes_[vertex * count_];
        const std::vector<uint32_t> offered(values, values + count_);
        if (nearest_corner < 0 || to_corner < nearest_corner) {
          answer = {offered, false};
        } else {
          answer.tied |= answer.values != offered;
          for (size_t n = 0; n < count_; ++n) answer.values[n] = std::min(answer.values[n], offered[n]);
        }
        nearest_corner = to_corner;
      }
    }
    return answer;
  }

 private:
  const Vec3i& At(uint32_t vertex) const { return mesh_.vertices_lat[vertex]; }
  double Distance(const Vec3i& a, const Vec3i& b) const {
    const Vec3d d = ToDouble(b - a);
    double square = 0;
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) square += d[r] * static_cast<double>(g_[c][r]) * d[c];
    }
    return std::sqrt(square);
  }

  const Mat<int64_t, 3> g_;
  const SnappedMesh mesh_;
  const std::vector<uint32_t> attributes_;
  const uint32_t count_;
  std::vector<double> longest_;  // of each triangle: the farther corner from the first
};

void SetRandomAttributes(uint32_t count, uint32_t below, std::mt19937& random, TriangleMesh& mesh) {
  mesh.attributes.resize(mesh.vertices.size() * count);
  for (uint32_t& value : mesh.attributes) value = static_cast<uint32_t>(random() % below);
}

// Triangles whose corners are multiples of `step` / 256 voxels, some without area.
TriangleMesh Soup(size_t triangles, int64_t step, const Lattice& lattice, std::mt19937& random) {
  oracle::Mesh mesh(triangles);
  for (oracle::Triangle& triangle : mesh) {
    for (oracle::Int3& corner : triangle) {
      for (int64_t& x : corner) x = static_cast<int64_t>(random() % (5 * 256)) / step * step;
    }
  }
  mesh.push_back({mesh[0][0], mesh[0][1], mesh[0][0]});
  mesh.push_back({mesh[1][2], mesh[1][2], mesh[1][2]});
  return ToWorld(mesh, lattice, {62, -3, 61});
}

// Returns how many of the voxels were tied.
size_t ExpectExact(const TriangleMesh& mesh, const Lattice& lattice, const VoxelizeOptions& options) {
  const Result result = Voxelize(mesh, Unscaled(lattice), options);
  const Oracle oracle(mesh, lattice, options.fields.size());
  size_t tied = 0;
  const Carried carried = CarriedBy(result, options.fields.size());
  EXPECT_EQ(carried.size(), result.totals.voxels);
  EXPECT_GT(carried.size(), 15U);
  for (const auto& [ijk, values] : carried) {
    const Answer answer = oracle.At(ijk);
    EXPECT_EQ(values, answer.values) << ijk[0] << ' ' << ijk[1] << ' ' << ijk[2];
    tied += answer.tied ? 1 : 0;
  }
  return tied;
}

TEST(Attributes, AreThoseOfTheNearestCornerOfTheNearestTriangle) {
  std::mt19937 random(5);
  size_t tied = 0, n = 0;
  for (const Lattice& lattice : Lattices()) {
    for (const int64_t step : {1, 128}) {
      VoxelizeOptions options{.fields = FirstFields(1 + n % kMaxAttributes)};
      options.separability = static_cast<int>(n % 3);
      options.minimal = n % 2 == 0;
      if (n % 4 == 3) options.cover = Cover::kSupercover;
      SCOPED_TRACE(testing::Message() << lattice.name() << " step " << step << " job " << n++);
      TriangleMesh mesh = Soup(10, step, lattice, random);
      SetRandomAttributes(options.fields.size(), 50, random, mesh);
      tied += ExpectExact(mesh, lattice, options);
    }
  }
  EXPECT_GT(tied, 10U);
}

// A box with faces between lattice points. Each face has its own value, so there are ties along edges and diagonals.
TEST(Attributes, OfTiesAreTheLeast) {
  for (const NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc}) {
    const Lattice lattice = Lattice::Named(name);
    TriangleMesh mesh;
    for (uint32_t face = 0; face < 6; ++face) {
      const auto first = static_cast<uint32_t>(mesh.vertices.size());
      const size_t axis = face / 2;
      for (uint32_t corner = 0; corner < 4; ++corner) {
        Vec3f& v = mesh.vertices.emplace_back();
        v[axis] = face % 2 == 0 ? 0 : 4;
        v[(axis + 1) % 3] = corner % 2 == 0 ? 0 : 4;
        v[(axis + 2) % 3] = corner < 2 ? 0 : 4;
        mesh.attributes.push_back(7 - face);
        mesh.attributes.push_back(face);
      }
      mesh.triangles.push_back({first, first + 1, first + 3});
      mesh.triangles.push_back({first, first + 3, first + 2});
    }
    const VoxelizeOptions options{.minimal = false, .fields = FirstFields(2)};
    EXPECT_GT(ExpectExact(mesh, lattice, options), 10U);
    // (0, 0, 0) is on the faces 0, 2 and 4.
    EXPECT_EQ(CarriedBy(Voxelize(mesh, Unscaled(lattice), options), 2).at({0, 0, 0}), (std::vector<uint32_t>{3, 0}));
  }
}

// There are so many triangles that offers are settled repeatedly. Copies of a triangle are at the same distance, so the
// smallest of their values counts.
TEST(Attributes, OfManyTrianglesInOnePlace) {
  constexpr uint32_t kCopies = 900;
  std::mt19937 random(11);
  const Lattice lattice = Lattice::Named(NamedLattice::kBcc);
  const oracle::Int3 a{0, 0, 0}, b{4500, 700, 300}, c{1200, 4800, 900}, d{4600, 4700, 2048};
  TriangleMesh once = ToWorld({{a, b, c}, {b, d, c}}, lattice, {6, 6, 6});
  once.attributes.assign(once.vertices.size() * 2, 1U << 30);
  TriangleMesh many;
  for (uint32_t copy = 0; copy < kCopies; ++copy) {
    for (auto triangle : once.triangles) {
      for (uint32_t& vertex : triangle) {
        for (uint32_t n = 0; n < 2; ++n) {
          many.attributes.push_back(static_cast<uint32_t>(random() % 1000000));
          once.attributes[2 * vertex + n] = std::min(once.attributes[2 * vertex + n], many.attributes.back());
        }
        many.vertices.push_back(once.vertices[vertex]);
        vertex = static_cast<uint32_t>(many.vertices.size() - 1);
      }
      many.triangles.push_back(triangle);
    }
  }
  std::shuffle(many.triangles.begin(), many.triangles.end(), random);
  const VoxelizeOptions options{.minimal = false, .fields = FirstFields(2)};
  ExpectExact(once, lattice, options);
  EXPECT_EQ(CarriedBy(Voxelize(many, Unscaled(lattice), options), 2),
            CarriedBy(Voxelize(once, Unscaled(lattice), options), 2));
}

// There are so many triangles that a job without attributes would leave out those that meet no lattice line.
TEST(Attributes, OfTrianglesFarSmallerThanVoxels) {
  TriangleMesh mesh = Sphere(64, 2.3F);
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) mesh.attributes.push_back(v / 4);
  ExpectExact(mesh, Lattice::Named(NamedLattice::kFcc), {.fields = FirstFields(1)});
}

TEST(Attributes, AreTheSameForAnyThreadsAndOrderAndPartsAddUp) {
  std::mt19937 random(9);
  TriangleMesh mesh = Sphere(20, 60);
  SetRandomAttributes(2, 1000, random, mesh);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  const Result whole = Voxelize(mesh, grid, {.fields = FirstFields(2)});
  const Carried carried = CarriedBy(whole, 2);
  EXPECT_EQ(whole.totals.digest, Voxelize(mesh, grid, {}).totals.digest);

  Digest sum;
  Carried joined;
  for (uint32_t index = 0; index < 3; ++index) {
    const Result part = Voxelize(mesh, grid, {.shard = Shard{index, 3}, .fields = FirstFields(2)});
    sum.Add(part.totals.attributes);
    joined.merge(CarriedBy(part, 2));
  }
  EXPECT_EQ(sum, whole.totals.attributes);
  EXPECT_EQ(joined, carried);

  const IndexBox region{{-30, -5, 7}, {33, 70, 41}};
  Carried in_region;
  std::copy_if(carried.begin(), carried.end(), std::inserter(in_region, in_region.end()),
               [&](const auto& voxel) { return region.Contains(voxel.first); });
  EXPECT_EQ(CarriedBy(Voxelize(mesh, grid, {.region = region, .fields = FirstFields(2)}), 2), in_region);

  const Bounds bounds{{-20, -30, -10}, {50, 41, 22}};
  Carried in_bounds;
  std::copy_if(carried.begin(), carried.end(), std::inserter(in_bounds, in_bounds.end()), [&](const auto& voxel) {
    const Vec3d center = Apply(grid.lattice.basis(), ToDouble(voxel.first));
    bool inside = true;
    for (size_t m = 0; m < 3; ++m) inside &= bounds.min[m] <= center[m] && center[m] <= bounds.max[m];
    return inside;
  });
  EXPECT_EQ(CarriedBy(Voxelize(mesh, grid, {.bounds = bounds, .fields = FirstFields(2)}), 2), in_bounds);

  const size_t half = whole.tiles.size() / 2;
  const Result rest = Voxelize(mesh, grid, {.resume_after = whole.tiles[half].tile_ijk, .fields = FirstFields(2)});
  ASSERT_EQ(rest.tiles.size(), whole.tiles.size() - half - 1);
  EXPECT_EQ(rest.tiles.front().attributes, whole.tiles[half + 1].attributes);

  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  for (auto& triangle : mesh.triangles) std::rotate(triangle.begin(), triangle.begin() + random() % 3, triangle.end());
  EXPECT_EQ(Voxelize(mesh, grid, {.fields = FirstFields(2)}, 1).totals.attributes, whole.totals.attributes);
  ++mesh.attributes[mesh.triangles[0][0] * 2];
  EXPECT_NE(Voxelize(mesh, grid, {.fields = FirstFields(2)}).totals.attributes, whole.totals.attributes);
}

TEST(Attributes, AreRefusedWhereTheyMeanNothing) {
  TriangleMesh mesh = Sphere(4, 10);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const auto refusal = [&](const VoxelizeOptions& options) {
    const auto job = VoxelizeJob::Create(mesh, grid, options);
    EXPECT_EQ(job.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(job.status().message());
  };
  EXPECT_THAT(refusal({.fields = FirstFields(1)}),
              HasSubstr("attributes: the mesh has 0 for 128 vertices, not 1 each"));
  mesh.attributes.resize(mesh.vertices.size());
  EXPECT_THAT(refusal({.algorithm = Algorithm::kBruteForce, .fields = FirstFields(1)}), HasSubstr("brute-force"));
  EXPECT_THAT(refusal({.solid = Solid{}, .fields = FirstFields(1)}), HasSubstr("solid"));
  EXPECT_THAT(refusal({.band = Band{.width = 1}, .fields = FirstFields(1)}), HasSubstr("band"));
}

}  // namespace
}  // namespace latvox
