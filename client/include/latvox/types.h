// A voxelization's request and answer, as plain values. proto/latvox/v1/voxelizer.proto describes every field; names,
// units and defaults here are the same.
//
// Frames: world coordinates are x, y, z in the mesh's units; lattice coordinates are the integers i, j, k, with
// world = origin + i*a + j*b + k*c.
#ifndef LATVOX_LATVOX_TYPES_H_
#define LATVOX_LATVOX_TYPES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "latvox/fields.h"
#include "latvox/lattice.h"
#include "latvox/sets.h"
#include "latvox/warning.h"

namespace latvox::client {

// The ways to find voxels. All except kExact are those of a thesis, for comparison: see Algorithm in the protocol.
enum class Algorithm {
  kExact,                 // the nearer ends of all lattice links that the mesh crosses
  kBruteForce,            // every lattice point within half a step of a triangle
  kIncremental,           // one voxel for each lattice line that meets a triangle
  kOptimizedIncremental,  // the same by one addition for each voxel
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

// The index-th of `count` parts with about the same cost; together they are the whole.
struct Shard {
  uint32_t index = 0;  // below count
  uint32_t count = 1;  // at most 1048576
  bool operator==(const Shard&) const = default;
};

// The encoding of bricks on the wire; the result is the same.
enum class BrickEncoding {
  kMasks,       // 76 bytes a brick
  kPacked,      // about a quarter of that
  kPackedZstd,  // a quarter less again, for twice the time on both sides: for networks below about one gigabit a second
};

// The place of lattice points in the mesh's bounding box: see Placement in the protocol.
enum class Placement {
  kPoints,  // `resolution` points span the longest side; lattice point 0 is the low corner
  kCells,   // `resolution` cells divide the longest side; lattice point 0 is half a voxel size above the low corner
};

// "points" or "cells".
constexpr const char* NameOf(Placement placement) { return placement == Placement::kPoints ? "points" : "cells"; }

// The layout of a mesh that is sent as plain arrays instead of a Draco stream: positions, triangles and fields, one
// after the other. See RawMesh in the protocol; EncodeRawMesh makes one.
struct RawMeshLayout {
  uint64_t vertices = 0;           // three numbers each
  uint64_t triangles = 0;          // three indices of vertices each, uint32
  bool has_doubles = false;        // positions are float64, otherwise float32
  std::vector<Field> fields = {};  // of the mesh: one uint32 for each vertex and field
  bool operator==(const RawMeshLayout&) const = default;
};

// The job. Give at most one of voxel_size and resolution; a named lattice needs one. The server refuses options that
// exclude each other with INVALID_ARGUMENT; proto/README.md lists them.
struct VoxelizeRequest {
  std::variant<NamedLattice, Basis> lattice = NamedLattice::kCartesian;  // a sampling scales a Basis uniformly
  std::optional<double> voxel_size = std::nullopt;    // edge of a cube with a Voronoi cell's volume, world units
  std::optional<uint32_t> resolution = std::nullopt;  // voxels along the longest side of the mesh's bounding box
  std::optional<Vec3d> origin = std::nullopt;         // world position of lattice point 0; default: by the placement
  uint32_t separability = 0;                          // k: 0, 1 or 2
  std::optional<bool> minimal = std::nullopt;  // thin the surface to k-minimality; default: wherever that is possible
  std::optional<IndexBox> region = std::nullopt;  // only these voxels, as in the whole
  std::optional<Shard> shard = std::nullopt;      // only this part of the tiles, as in the whole
  bool verify = false;                      // count tunnels and redundant voxels of the finished set independently
  Algorithm algorithm = Algorithm::kExact;  // the way to find the voxels
  BrickEncoding encoding = BrickEncoding::kPacked;  // their encoding on the wire
  VoxelSet set = Surface{};                         // the lattice points to find
  std::vector<Field> fields = {};                   // carried by each of them, each once; the mesh must have its own
  bool signed_distance = false;                     // Field::kDistance is negative inside
  // The rule for the inside, for signed_distance, Field::kFraction and one side of Links. Without any of these, and for
  // a Solid, which has a rule of its own, only kAuto is allowed.
  InteriorRule interior_rule = InteriorRule::kAuto;
  // For Field::kFraction and kLabelFractions: the number of points along each axis of a cell, 2 to 16. Otherwise 0.
  uint32_t fraction_n = 0;
  // For Field::kLabelFractions: the labels, each once, at most 32; none: all of the mesh, ascending.
  std::vector<uint32_t> fraction_labels = {};
  // Only voxels whose centers lie in this box, exactly as in the whole; the lattice does not move.
  std::optional<WorldBox> bounds = std::nullopt;
  std::optional<RawMeshLayout> raw_mesh = std::nullopt;  // layout of the mesh's bytes; default: they are a Draco stream
  // The place of lattice points, as far as size and origin leave it open. Default: kCells for Solid, Enclosed and
  // Connected, else kPoints.
  std::optional<Placement> placement = std::nullopt;
};

// Returns whether signs, fractions or one side of links depend on VoxelizeRequest::interior_rule.
inline bool NeedsInteriorRule(const VoxelizeRequest& request) {
  if (std::holds_alternative<Solid>(request.set)) return false;
  const auto* const links = std::get_if<Links>(&request.set);
  return request.signed_distance || request.fraction_n != 0 || (links != nullptr && links->side != LinkSide::kBoth);
}

// World positions of lattice coordinates: world = origin + i*a + j*b + k*c.
struct GridTransform {
  Basis basis;            // scaled, world units
  Vec3d origin{};         // world position of lattice point 0
  double voxel_size = 0;  // edge of a cube with a Voronoi cell's volume, world units

  // Returns the center of a voxel.
  Vec3d ToWorld(const Vec3i& ijk) const {
    Vec3d world{};
    for (size_t m = 0; m < 3; ++m) {
      world[m] = origin[m] + ijk[0] * basis.a[m] + ijk[1] * basis.b[m] + ijk[2] * basis.c[m];
    }
    return world;
  }
  bool operator==(const GridTransform&) const = default;
};

// Facts about the mesh from the server.
struct MeshFacts {
  uint64_t triangles = 0;             // as decoded
  uint64_t vertices = 0;              // as decoded: codecs split and duplicate them
  uint64_t degenerate_triangles = 0;  // without area after snapping
  bool closed = false;                // every edge, by snapped position, belongs to an even number of triangles
  uint32_t quantization_bits = 0;     // of a position in the Draco stream; 0: none
  double snap_error_max = 0;          // the most that snapping moved a vertex, in each lattice coordinate, in voxels
  Vec3d min{};                        // bounding box of all triangles, world: the low corner
  Vec3d max{};                        // and the high one
  bool operator==(const MeshFacts&) const = default;
};

// The way in which a mesh was read and encoded, as far as it is not the default. Grids record it with the request, so
// that the request can be repeated. The names are those of fields in a line of `latvox batch`.
struct MeshNote {
  std::string up_axis;                            // "x", "y" or "z": the axis of the file that became z
  std::optional<double> scale;                    // of its coordinates
  std::string input_format;                       // "ply", ...: overrides the file's extension
  std::optional<int> quantization;                // bits of a position on the way to the server; 0: lossless
  bool skip_bad = false;                          // broken elements were left out
  std::vector<std::string> priority = {};         // Solid.priority in words: numbers, and names from the file
  std::vector<std::string> fraction_labels = {};  // VoxelizeRequest.fraction_labels in such words
  std::optional<MeshFacts> facts = std::nullopt;  // as the server found them: they tell the parts of two meshes apart
  std::optional<double> alpha_cutoff = std::nullopt;  // voxels of less opacity, 0 to 1, were left out
  bool operator==(const MeshNote&) const = default;
};

// The request as it will be carried out: the first answer.
struct Accepted {
  std::string request_id;             // in the server's log
  GridTransform grid;                 // where lattice points are
  std::optional<IndexBox> index_box;  // no voxel lies outside; absent: there are no voxels
  uint64_t tiles_in_box = 0;          // 64^3 tiles that meet index_box
  MeshFacts mesh;                     // facts from the server
  Placement placement = {};           // the one that was used
  // For a request with fields of links: lattice vectors to the k-neighbors, in lexicographic order.
  std::vector<Vec3i> neighbors = {};
  // For Field::kLabelFractions: the labels, in the order of a voxel's numbers.
  std::vector<uint32_t> fraction_labels = {};

  // Returns values of no voxel for a field that voxels carry.
  FieldValues NoValues(Field field) const {
    const FieldFacts& facts = FactsOf(field);
    return {field,
            {},
            facts.is_of_links() ? neighbors.size() : 0,
            facts.is_of_labels() ? fraction_labels : std::vector<uint32_t>{}};
  }
};

// 8 x 8 x 8 voxels; brick_ijk is ijk >> 3. Voxel (x, y, z) of the brick is bit (y<<3 | z) of word x.
struct Brick {
  Vec3i brick_ijk;               // lattice coordinates >> 3
  std::array<uint64_t, 8> mask;  // never empty
};

// The next bricks. Their memory belongs to the SDK, until the handler returns, or until the next Next of a BrickStream.
struct BrickBatch {
  std::span<const Brick> bricks;             // whole 64^3 tiles, except where their fields are large
  double progress = 0;                       // share of the work done, 0 to 1, never decreasing
  std::span<const FieldValues> fields = {};  // of their voxels: one for each of VoxelizeRequest.fields, in their order
};

// The inside of a mesh.
struct SolidFacts {
  std::string rule;               // the one that was used: "parity", "winding" or "positive"
  uint64_t unbalanced_lines = 0;  // lattice lines along k without an interior; 0 if the mesh is closed by the rule
};

// A band.
struct BandFacts {
  double width = 0;  // world units
};

// The way by which a walk gets outside: see Leak in the protocol.
struct Leak {
  // Whether a walk from the point gets outside.
  enum class Kind {
    kNone,         // it does not: the point is enclosed
    kInSurface,    // the point is a voxel of the surface, or too near to the mesh
    kFound,        // it does, by this path
    kBoxTooLarge,  // it does; the mesh's box has too many points to search for a path
  };
  Kind kind = Kind::kNone;       // whether there is a way
  Vec3i from{};                  // the lattice point where it begins
  uint64_t steps = 0;            // of the whole way
  std::vector<Vec3i> path = {};  // its lattice points: at most 4096, around the narrowest
  Vec3i narrowest{};             // the point with the least room, in the middle of the hole
  Vec3d narrowest_world{};       // its world position
  double room = 0;               // its distance from the mesh, world units; negative: the lattice is too skewed for it
  uint64_t box_points = 0;       // the lattice points of the mesh's box
};

// The facts of one label of an enclosed set: see LabelWalk in the protocol.
struct LabelWalk {
  uint32_t label = 0;                       // its number
  uint64_t cavities = 0;                    // as in WalkFacts, of its triangles alone
  uint64_t points = 0;                      // the lattice points of these cavities
  std::optional<Leak> leak = std::nullopt;  // for Enclosed::leak_from
};

// Facts about the whole mesh, from a walk.
struct WalkFacts {
  uint64_t cavities = 0;                        // connected sets that no walk from outside reaches
  std::vector<uint64_t> largest_cavities = {};  // their numbers of lattice points, descending: at most 16
  std::optional<Leak> leak = std::nullopt;      // for Enclosed::leak_from; not with labels
  std::vector<LabelWalk> labels = {};           // for Enclosed::labels, ascending
};

// A field of a result.
struct FieldCertificate {
  Field field = Field::kPart;  // the field that voxels carry
  std::string digest;          // of voxels and field, 32 hexadecimal digits
  bool operator==(const FieldCertificate&) const = default;
};

// Properties of the result, proved or checked.
struct Certificate {
  std::string lattice;             // "cartesian", "bcc", "fcc", "hexagonal", "stretched-" and one of these, or "basis"
  uint32_t separability = 0;       // k
  bool tunnel_free = false;        // every crossed lattice link has an end in the set; for a part: in the whole
  bool minimal = false;            // no voxel can leave
  bool verified = false;           // the next two were counted for this result
  uint64_t tunnels = 0;            // crossed lattice links without an end in the set; valid if verified
  uint64_t redundant = 0;          // voxels that could leave; valid if verified
  bool closed = false;             // as in MeshFacts
  double snap_error_max = 0;       // as in MeshFacts
  uint32_t quantization_bits = 0;  // as in MeshFacts
  std::string algorithm;           // "exact", "brute-force", "incremental" or "optimized-incremental"
  std::string version;             // of the server
  std::string digest;              // identifies the voxel set: 32 hexadecimal digits
  std::optional<Shard> shard;      // the shard, if the request asked for one
  std::string set;                 // the name of the set, as NameOf gives it
  std::optional<SolidFacts> solid = std::nullopt;  // for a solid
  std::optional<BandFacts> band = std::nullopt;    // for a band
  std::vector<FieldCertificate> fields = {};       // one for each of VoxelizeRequest.fields, in their order
  bool signed_distance = false;                    // as in the request
  uint32_t fraction_n = 0;                         // as in the request
  std::vector<uint32_t> fraction_labels = {};      // as in Accepted
  bool whole_minimal = false;                      // `minimal` of the whole to which this part belongs
  std::optional<WalkFacts> walk = std::nullopt;    // for an enclosed set and a region
  // The rule that was used for VoxelizeRequest::interior_rule: "parity", "winding" or "positive". Empty for a solid,
  // and where nothing depends on the inside.
  std::string interior_rule = {};
};

// Wall-clock milliseconds within the server; for a resumed call, within the last server.
struct ServerTimings {
  double upload_ms = 0;    // from the specification's arrival to the mesh's last byte; 0: no mesh was sent
  double decode_ms = 0;    // Draco decoding and checking; 0 if the server had the decoded mesh
  double voxelize_ms = 0;  // snapping, digitizing, thinning and, if requested, verifying
  double stream_ms = 0;    // the wait for the client to take bricks, and then for another turn
};

// The last answer: nothing is missing.
struct Summary {
  uint64_t voxels = 0;                 // passed on, over all streams
  uint64_t bricks = 0;                 // likewise
  uint64_t tiles = 0;                  // 64^3 tiles with voxels, likewise
  Certificate certificate;             // properties of the result
  ServerTimings timings;               // time of each stage
  uint64_t mesh_bytes = 0;             // of the encoded mesh
  int resumed = 0;                     // times that the stream broke and another one continued
  uint64_t bytes_sent = 0;             // of messages as counted by this client, over all tries
  uint64_t bytes_received = 0;         // likewise
  std::vector<Warning> warnings = {};  // what is probably not meant, such as an empty result
};

// A whole voxelization in memory.
struct Voxelization {
  Accepted accepted;                     // grid and box
  std::vector<Brick> bricks;             // in the order of their arrival, which is the same each time
  Summary summary;                       // counts and certificate
  std::vector<FieldValues> fields = {};  // of their voxels, as in BrickBatch
};

// A library of a server.
struct Library {
  std::string name;     // such as "gRPC"
  std::string version;  // such as "1.51.1"
};

// The limits of requests.
struct Limits {
  uint64_t max_mesh_bytes = 0;       // of an encoded mesh
  uint64_t max_triangles = 0;        // of a mesh
  uint64_t max_vertices = 0;         // of a mesh, as decoded
  uint32_t max_extent = 0;           // voxels along any lattice axis of the mesh's index box
  uint32_t max_jobs = 0;             // at work at once
  uint64_t max_message_bytes = 0;    // of one message to the server
  uint32_t subvoxel_bits = 0;        // fractional bits of the lattice coordinates that vertices are snapped to
  std::string version;               // of the server
  uint64_t max_points = 0;           // for Pixelize: in all polylines
  uint64_t max_crossings = 0;        // for Pixelize: crossed lattice links, by an upper estimate
  uint64_t max_pixels = 0;           // for Pixelize: in the answer
  uint32_t max_queued_jobs = 0;      // waiting jobs; one more is refused for the moment
  uint32_t max_jobs_per_client = 0;  // for one token, else for one network address
  uint64_t memory_budget_bytes = 0;  // shared by all jobs and stored meshes
  uint64_t mesh_store_bytes = 0;     // for all stored meshes
  uint64_t max_visited_points = 0;   // lattice points that one request looks at, by the server's estimate
  double max_job_seconds = 0;        // CPU time of one job, without decoding its mesh
  std::string commit = {};           // of the server: 40 digits, "-modified" after them if files differed; or "unknown"
  std::vector<Library> libraries = {};  // that the server was built with, in the order of their names
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_TYPES_H_
