// What a voxelization asks for and what it answers, as plain values. The protocol's own description of every field is
// in proto/latvox/v1/voxelizer.proto; names, units and defaults here are the same.
//
// Frames: world coordinates are x, y, z in the mesh's units; lattice coordinates are the integers i, j, k, with
// world = origin + i*a + j*b + k*c.
#ifndef LATVOX_CLIENT_TYPES_H_
#define LATVOX_CLIENT_TYPES_H_

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

namespace latvox::client {

using Vec3d = std::array<double, 3>;
using Vec3i = std::array<int32_t, 3>;

enum class NamedLattice { kCartesian, kBcc, kFcc, kHexagonal };

// How to find the voxels. All but kExact are there to compare with.
enum class Algorithm { kExact, kBruteForce, kIncremental, kOptimizedIncremental };

// The world vectors of one step in i, j and k.
struct Basis {
  Vec3d a{1, 0, 0}, b{0, 1, 0}, c{0, 0, 1};
  bool operator==(const Basis&) const = default;
};

// A half-open box of lattice points: min <= ijk < max on every axis.
struct IndexBox {
  Vec3i min{}, max{};
  bool operator==(const IndexBox&) const = default;
};

// The index-th of `count` parts that cost about the same, and that together are the whole.
struct Shard {
  uint32_t index = 0, count = 1;  // index < count <= 1048576
  bool operator==(const Shard&) const = default;
};

// The lattice points near the mesh, each with its distance: see Band in the protocol.
struct Band {
  double width = 0;        // finite, > 0
  bool in_voxels = false;  // width counts GridTransform.voxel_size; otherwise world units
  bool is_signed = false;  // distances are negative inside; the mesh must be closed
};

// How bricks travel; what arrives is the same. kPacked has about a quarter of kMasks' bytes; kPackedZstd a quarter less
// again, for twice the time on both sides: it pays on networks below about one gigabit a second.
enum class BrickEncoding { kMasks, kPacked, kPackedZstd };

// What to compute. At most one of voxel_size and resolution; a named lattice needs one of them.
struct VoxelizeRequest {
  std::variant<NamedLattice, Basis> lattice = NamedLattice::kCartesian;
  std::optional<double> voxel_size;    // edge of a cube with a Voronoi cell's volume, world units
  std::optional<uint32_t> resolution;  // voxels along the longest side of the mesh's bounding box
  std::optional<Vec3d> origin;         // world position of lattice point 0; default: the mesh's low corner
  uint32_t separability = 0;           // k: 0, 1 or 2
  bool minimal = true;                 // applies to kExact only
  std::optional<IndexBox> region;      // only these voxels, as they are in the whole
  std::optional<Shard> shard;          // only this part of the tiles, as they are in the whole
  bool verify = false;                 // count tunnels and redundant voxels independently; not with region or shard
  Algorithm algorithm = Algorithm::kExact;
  BrickEncoding encoding = BrickEncoding::kPacked;
  // A band instead of voxels that separate. Not with verify, with a separability other than 0, or with an algorithm
  // other than kExact; minimal does not apply.
  std::optional<Band> band = std::nullopt;
};

// World positions of lattice coordinates: world = origin + i*a + j*b + k*c.
struct GridTransform {
  Basis basis;
  Vec3d origin{};
  double voxel_size = 0;

  Vec3d ToWorld(const Vec3i& ijk) const {
    Vec3d world{};
    for (size_t m = 0; m < 3; ++m) {
      world[m] = origin[m] + ijk[0] * basis.a[m] + ijk[1] * basis.b[m] + ijk[2] * basis.c[m];
    }
    return world;
  }
  bool operator==(const GridTransform&) const = default;
};

// The mesh as the server found it.
struct MeshFacts {
  uint64_t triangles = 0, vertices = 0, degenerate_triangles = 0;
  bool closed = false;
  uint32_t quantization_bits = 0;
  double snap_error_max = 0;
  Vec3d min{}, max{};  // bounding box, world
  bool operator==(const MeshFacts&) const = default;
};

// The request as it will be carried out: the first answer.
struct Accepted {
  std::string request_id;
  GridTransform grid;
  std::optional<IndexBox> index_box;  // no voxel lies outside; absent: there is no voxel
  uint64_t tiles_in_box = 0;
  MeshFacts mesh;
};

// 8 x 8 x 8 voxels; brick_ijk is ijk >> 3. Voxel (x, y, z) of the brick is bit (y<<3 | z) of word x.
struct Brick {
  Vec3i brick_ijk;
  std::array<uint64_t, 8> mask;  // never empty
};

// The next bricks. The memory belongs to the caller of the callback and is gone when the callback returns.
struct BrickBatch {
  std::span<const Brick> bricks;
  double progress = 0;  // share of the work done, 0 to 1, never decreasing
  // Of a band: the distance of each voxel, world units; brick after brick, of a brick in lexicographic order of ijk.
  std::span<const float> values = {};
};

// What the distances of a band are.
struct BandCertificate {
  double width = 0;  // world units
  bool is_signed = false;
  std::string digest;  // of voxels and distances, 32 hexadecimal digits
};

// What was proved or checked of the result.
struct Certificate {
  std::string lattice;  // "cartesian", "bcc", "fcc", "hexagonal" or "basis"
  uint32_t separability = 0;
  bool tunnel_free = false;
  bool minimal = false;
  bool verified = false;
  uint64_t tunnels = 0, redundant = 0;  // meaningful if verified
  bool closed = false;
  double snap_error_max = 0;
  uint32_t quantization_bits = 0;
  std::string algorithm, version;
  std::string digest;                                  // 32 hexadecimal digits
  std::optional<Shard> shard;                          // the part that this is, if one was asked for
  std::optional<BandCertificate> band = std::nullopt;  // if one was asked for
};

// Wall-clock milliseconds within the server; of a resumed call, within the last one.
struct ServerTimings {
  double upload_ms = 0, decode_ms = 0, voxelize_ms = 0, stream_ms = 0;
};

// The last answer: nothing is missing.
struct Summary {
  uint64_t voxels = 0, bricks = 0, tiles = 0;
  Certificate certificate;
  ServerTimings timings;
  uint64_t mesh_bytes = 0;
  int resumed = 0;  // times that the stream broke and another one went on
  // Bytes of messages as this client counted them, over all tries.
  uint64_t bytes_sent = 0, bytes_received = 0;
};

// The limits that requests are held against.
struct Limits {
  uint64_t max_mesh_bytes = 0, max_triangles = 0, max_vertices = 0;
  uint32_t max_extent = 0, max_jobs = 0;
  uint64_t max_message_bytes = 0;
  uint32_t subvoxel_bits = 0;
  std::string version;
  uint64_t max_points = 0, max_crossings = 0, max_pixels = 0;  // of Pixelize
  uint32_t max_queued_jobs = 0, max_jobs_per_client = 0;
  uint64_t memory_budget_bytes = 0, mesh_store_bytes = 0, max_voxels = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TYPES_H_
