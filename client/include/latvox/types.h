// What a voxelization asks for and what it answers, as plain values. The protocol's own description of every field is
// in proto/latvox/v1/voxelizer.proto; names, units and defaults here are the same.
//
// Frames: world coordinates are x, y, z in the mesh's units; lattice coordinates are the integers i, j, k, with
// world = origin + i*a + j*b + k*c.
#ifndef LATVOX_LATVOX_TYPES_H_
#define LATVOX_LATVOX_TYPES_H_

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace latvox::client {

using Vec3d = std::array<double, 3>;   // a world position or vector: x, y, z
using Vec3i = std::array<int32_t, 3>;  // lattice coordinates: i, j, k

// The world vectors of one step in i, j and k.
struct Basis {
  Vec3d a{1, 0, 0};  // of i
  Vec3d b{0, 1, 0};  // of j
  Vec3d c{0, 0, 1};  // of k
  bool operator==(const Basis&) const = default;
};

// The common lattices, in the protocol's order.
enum class NamedLattice {
  kCartesian,  // cubes
  kBcc,        // body-centered cubic
  kFcc,        // face-centred cubic
  kHexagonal,  // hexagonal prism
};

// A common lattice: its value, its name, and its basis up to scale.
struct NamedBasis {
  NamedLattice lattice;  // its value
  const char* name;      // in the protocol, in files and on the command line
  Basis basis;           // up to scale
};

// All of them, in the order of their values.
inline constexpr std::array kNamedLattices{
    NamedBasis{NamedLattice::kCartesian, "cartesian", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
    NamedBasis{NamedLattice::kBcc, "bcc", {{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}},
    NamedBasis{NamedLattice::kFcc, "fcc", {{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}},
    NamedBasis{NamedLattice::kHexagonal,
               "hexagonal",
               {{1, 0, 0}, {0.5, 0x1.bb67ae8584caap-1, 0}, {0, 0, 1}}},  // (1/2, sqrt(3)/2, 0)
};

// "cartesian", "bcc", "fcc" or "hexagonal".
constexpr const char* NameOf(NamedLattice lattice) { return kNamedLattices[static_cast<size_t>(lattice)].name; }

// How to find the voxels. All but kExact are there to compare with.
enum class Algorithm {
  kExact,                 // the nearer ends of all lattice edges that the mesh crosses
  kBruteForce,            // of the thesis, as the other two
  kIncremental,           // one voxel for each lattice line that meets a triangle
  kOptimizedIncremental,  // the same by one addition a voxel
};

// Which voxels to find: a set that separates, or every one whose closed Voronoi cell meets the mesh (conservative).
enum class Cover {
  kSeparating,  // few, and none along a path through the mesh is missing
  kSupercover,  // all
};

// A half-open box of lattice points: min <= ijk < max on every axis.
struct IndexBox {
  Vec3i min{};  // the lowest point, inside
  Vec3i max{};  // the highest one, outside
  bool operator==(const IndexBox&) const = default;
};

// A closed box of the world: min <= position <= max on every axis.
struct WorldBox {
  Vec3d min{};  // the lowest corner, inside
  Vec3d max{};  // the highest one, inside
  bool operator==(const WorldBox&) const = default;
};

// The index-th of `count` parts that cost about the same, and that together are the whole.
struct Shard {
  uint32_t index = 0;  // below count
  uint32_t count = 1;  // 1048576 at most
  bool operator==(const Shard&) const = default;
};

// The lattice points near the mesh, each with its distance: see Band in the protocol.
struct Band {
  double width = 0;        // finite, 1/8192 of a voxel size at least
  bool in_voxels = false;  // width counts GridTransform.voxel_size; otherwise world units
  bool is_signed = false;  // distances are negative inside; the mesh must be closed
};

// What voxels may carry of the mesh: the number of the nearest corner of the nearest triangle. See Attribute in the
// protocol, which also says how a Draco mesh has them.
enum class Attribute {
  kPart,      // which part of the mesh
  kMaterial,  // which material
  kColor,     // red, green and blue of 0 to 255: red << 16 | green << 8 | blue
};

// "part", "material" or "color".
constexpr const char* NameOf(Attribute attribute) {
  constexpr const char* kNames[] = {"part", "material", "color"};
  return kNames[static_cast<size_t>(attribute)];
}

// How bricks travel; what arrives is the same.
enum class BrickEncoding {
  kMasks,       // 76 bytes a brick
  kPacked,      // about a quarter of that
  kPackedZstd,  // a quarter less again, for twice the time on both sides: for networks below about one gigabit a second
};

// Which lattice points are inside of a mesh: by an odd number of crossings with it on the way there, or by a sum of
// these other than 0, each + or - by the triangle's orientation.
enum class InteriorRule {
  kParity,   // an odd number
  kWinding,  // a sum other than 0
};

// To fill a mesh, which must be closed: every edge in an even number of triangles (kParity), or run through equally
// often both ways (kWinding).
struct Solid {
  InteriorRule rule = InteriorRule::kParity;  // what is inside
  bool surface = true;                        // with the surface's voxels, too
  bool force_open = false;  // fill a mesh that is not closed along those lattice lines in k that are balanced
  bool operator==(const Solid&) const = default;
};

// What to compute. Give at most one of voxel_size and resolution; a named lattice needs one. The server refuses options
// that exclude each other with INVALID_ARGUMENT; proto/README.md lists them.
struct VoxelizeRequest {
  std::variant<NamedLattice, Basis> lattice = NamedLattice::kCartesian;  // a sampling scales a Basis uniformly
  std::optional<double> voxel_size;         // edge of a cube with a Voronoi cell's volume, world units
  std::optional<uint32_t> resolution;       // voxels along the longest side of the mesh's bounding box
  std::optional<Vec3d> origin;              // world position of lattice point 0; default: the mesh's low corner
  uint32_t separability = 0;                // k: 0, 1 or 2
  std::optional<bool> minimal;              // thin the surface to k-minimality; default: wherever that is possible
  std::optional<IndexBox> region;           // only these voxels, as they are in the whole
  std::optional<Shard> shard;               // only this part of the tiles, as they are in the whole
  bool verify = false;                      // count tunnels and redundant voxels of the finished set independently
  Algorithm algorithm = Algorithm::kExact;  // how to find the voxels
  BrickEncoding encoding = BrickEncoding::kPacked;  // how they travel
  std::optional<Solid> solid;                       // the points inside the mesh, too
  Cover cover = Cover::kSeparating;                 // kSupercover: the same voxels for every separability
  std::optional<Band> band = std::nullopt;          // points near the mesh, with distances, instead of a surface
  std::vector<Attribute> attributes = {};           // what voxels carry, each once; the mesh must have it
  // Only voxels whose centers lie in this box, exactly, as they are in the whole; the lattice does not move.
  std::optional<WorldBox> bounds = std::nullopt;
};

// How a mesh was read and encoded before it was sent, as far as that is not by default: what grids tell beside the
// request, for those who repeat it. The fields of these names in a line of `latvox batch`.
struct MeshNote {
  std::string up_axis;              // "x", "y" or "z": the axis of the file that became z
  std::optional<double> scale;      // of its coordinates
  std::string input_format;         // "ply", ...: whatever its extension says
  std::optional<int> quantization;  // bits of a position on the way to the server; 0: lossless
  bool operator==(const MeshNote&) const = default;
};

// World positions of lattice coordinates: world = origin + i*a + j*b + k*c.
struct GridTransform {
  Basis basis;            // scaled, world units
  Vec3d origin{};         // world position of lattice point 0
  double voxel_size = 0;  // edge of a cube with a Voronoi cell's volume, world units

  // The centre of a voxel.
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
  uint64_t triangles = 0;             // as decoded
  uint64_t vertices = 0;              // as decoded: codecs split and duplicate them
  uint64_t degenerate_triangles = 0;  // without area after snapping
  bool closed = false;                // every edge, by snapped position, belongs to an even number of triangles
  uint32_t quantization_bits = 0;     // of a position in the Draco stream; 0: none
  double snap_error_max = 0;          // most by which snapping moved a vertex, in each lattice coordinate, in voxels
  Vec3d min{};                        // bounding box of all triangles, world: the low corner
  Vec3d max{};                        // and the high one
  bool operator==(const MeshFacts&) const = default;
};

// The request as it will be carried out: the first answer.
struct Accepted {
  std::string request_id;             // in the server's log
  GridTransform grid;                 // where lattice points are
  std::optional<IndexBox> index_box;  // no voxel lies outside; absent: there is no voxel
  uint64_t tiles_in_box = 0;          // 64^3 tiles that meet index_box
  MeshFacts mesh;                     // as the server found it
};

// 8 x 8 x 8 voxels; brick_ijk is ijk >> 3. Voxel (x, y, z) of the brick is bit (y<<3 | z) of word x.
struct Brick {
  Vec3i brick_ijk;               // lattice coordinates >> 3
  std::array<uint64_t, 8> mask;  // never empty
};

// The next bricks. The memory is the SDK's, and gone when the handler returns, or at the next Next of a BrickStream.
struct BrickBatch {
  std::span<const Brick> bricks;  // whole 64^3 tiles
  double progress = 0;            // share of the work done, 0 to 1, never decreasing
  // Of a band: the distance of each voxel, world units; brick after brick, of a brick in lexicographic order of ijk.
  std::span<const float> values = {};
  // With VoxelizeRequest.attributes: as many numbers for each voxel, in their order; voxels are in that of `values`.
  std::span<const uint32_t> attributes = {};
};

// How a mesh was filled.
struct SolidFacts {
  std::string rule;               // "parity" or "winding"
  bool surface = true;            // with the surface's voxels, too
  uint64_t unbalanced_lines = 0;  // along k, which have no interior; 0 if the mesh is closed
};

// What the distances of a band are.
struct BandCertificate {
  double width = 0;        // world units
  bool is_signed = false;  // distances inside are negative
  std::string digest;      // of voxels and distances, 32 hexadecimal digits
};

// What the voxels carry.
struct AttributeCertificate {
  std::vector<Attribute> attributes;  // as VoxelizeRequest has them
  std::string digest;                 // of voxels and what they carry, 32 hexadecimal digits
};

// What was proved or checked of the result.
struct Certificate {
  std::string lattice;              // "cartesian", "bcc", "fcc", "hexagonal", "stretched-" and one of these, or "basis"
  uint32_t separability = 0;        // k
  bool tunnel_free = false;         // every crossed lattice edge has an end in the set; of a part, in the whole of it
  bool minimal = false;             // no voxel can leave
  bool verified = false;            // the next two were counted on this very result
  uint64_t tunnels = 0;             // crossed lattice edges with no end in the set; meaningful if verified
  uint64_t redundant = 0;           // voxels that could leave; meaningful if verified
  bool closed = false;              // as MeshFacts has it, like the next two
  double snap_error_max = 0;        // voxels
  uint32_t quantization_bits = 0;   // 0: none
  std::string algorithm;            // "exact", "brute-force", "incremental" or "optimized-incremental"
  std::string version;              // of the server
  std::string digest;               // identifies the voxel set: 32 hexadecimal digits
  std::optional<Shard> shard;       // the part that this is, if one was asked for
  std::optional<SolidFacts> solid;  // how the mesh was filled, if it was
  std::string cover;                // "separating" or "supercover"
  std::optional<BandCertificate> band = std::nullopt;             // what the distances are, if a band was asked for
  std::optional<AttributeCertificate> attributes = std::nullopt;  // what the voxels carry, if anything
  bool whole_minimal = false;                                     // minimal is true of the whole that this is a part of
};

// Wall-clock milliseconds within the server; of a resumed call, within the last one.
struct ServerTimings {
  double upload_ms = 0;    // from the specification's arrival to that of the mesh's last byte; 0: none was sent
  double decode_ms = 0;    // Draco decoding and checking; 0 if its result was kept
  double voxelize_ms = 0;  // snapping, digitizing, thinning and, if asked for, verifying
  double stream_ms = 0;    // waiting for the client to take bricks
};

// The last answer: nothing is missing.
struct Summary {
  uint64_t voxels = 0;          // handed on, over all streams
  uint64_t bricks = 0;          // likewise
  uint64_t tiles = 0;           // 64^3 tiles with voxels, likewise
  Certificate certificate;      // what the result is
  ServerTimings timings;        // where the time went
  uint64_t mesh_bytes = 0;      // of the encoded mesh
  int resumed = 0;              // times that the stream broke and another one went on
  uint64_t bytes_sent = 0;      // of messages as this client counted them, over all tries
  uint64_t bytes_received = 0;  // likewise
};

// A whole voxelization in memory.
struct Voxelization {
  Accepted accepted;                      // grid and box
  std::vector<Brick> bricks;              // in the order in which they came, which is the same each time
  std::vector<float> values;              // of a band: their voxels' distances, as BrickBatch has them
  Summary summary;                        // counts and certificate
  std::vector<uint32_t> attributes = {};  // what their voxels carry, as BrickBatch has it
};

// The limits that requests are held against.
struct Limits {
  uint64_t max_mesh_bytes = 0;       // of an encoded mesh
  uint64_t max_triangles = 0;        // of a mesh
  uint64_t max_vertices = 0;         // of a mesh, as decoded
  uint32_t max_extent = 0;           // voxels along any lattice axis of the mesh's index box
  uint32_t max_jobs = 0;             // at work at once
  uint64_t max_message_bytes = 0;    // one message in either direction
  uint32_t subvoxel_bits = 0;        // fractional bits of the lattice coordinates that vertices are snapped to
  std::string version;               // of the server
  uint64_t max_points = 0;           // of Pixelize: in all polylines
  uint64_t max_crossings = 0;        // of Pixelize: lattice edges that are crossed, by an upper estimate
  uint64_t max_pixels = 0;           // of Pixelize: in the answer
  uint32_t max_queued_jobs = 0;      // that wait; one more is refused for the moment
  uint32_t max_jobs_per_client = 0;  // of one token, else of one network address
  uint64_t memory_budget_bytes = 0;  // that all jobs and stored meshes share
  uint64_t mesh_store_bytes = 0;     // of all meshes that are kept
  uint64_t max_visited_points = 0;   // lattice points that one request looks at, by the server's estimate
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_TYPES_H_
