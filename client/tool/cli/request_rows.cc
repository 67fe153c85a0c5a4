#include "client/tool/cli/request_rows.h"

#include <array>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/mesh/mesh_encoder.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/request_words.h"
#include "client/tool/cli/set_options.h"
#include "client/tool/cli/shape_options.h"
#include "client/tool/output/output.h"

namespace latvox::client {
namespace {

using Rows = std::vector<OptionRow>;

WrongWord CheckVoxelSize(const std::string& text) {
  if (!absl::StrContains(text, ',')) return CheckPositive(text);
  Vec3d sizes;
  if (ParseNumbers(text, sizes) && sizes[0] > 0 && sizes[1] > 0 && sizes[2] > 0) return "";
  return {absl::StrCat("\"", text, "\" is not one or three finite numbers above 0"), text, "0"};
}

WrongWord CheckRegion(const std::string& text) {
  if (auto error = CheckNumbers<int32_t, 6>(text); !error.empty()) return error;
  std::array<int32_t, 6> box;
  ParseNumbers(text, box);
  for (size_t m = 0; m < 3; ++m) {
    if (box[m] >= box[m + 3]) {
      return {absl::StrCat("\"", text, "\" is empty: ", box[m + 3], " does not exceed ", box[m], " on lattice axis ",
                           absl::string_view("ijk").substr(m, 1)),
              absl::StrCat(box[m + 3]), absl::StrCat(box[m])};
    }
  }
  return "";
}

WrongWord CheckBounds(const std::string& text) {
  if (auto error = CheckNumbers<double, 6>(text); !error.empty()) return error;
  std::array<double, 6> box;
  ParseNumbers(text, box);
  for (size_t m = 0; m < 3; ++m) {
    if (box[m] > box[m + 3]) {
      return {absl::StrCat("\"", text, "\" is empty: ", box[m + 3], " is below ", box[m], " on axis ",
                           absl::string_view("xyz").substr(m, 1)),
              absl::StrCat(box[m + 3]), absl::StrCat(box[m])};
    }
  }
  return "";
}

WrongWord CheckQuantization(const std::string& text) {
  int64_t bits = 0;
  if (text == "auto" || (ParseNumber(text, bits) && bits >= 0 && bits <= kMaxQuantizationBits)) return "";
  const std::string range = absl::StrCat("0 to ", kMaxQuantizationBits);
  return {absl::StrCat("\"", text, "\" is neither auto nor a whole number from ", range), text, range};
}

OptionRow VoxelOutputRow(VoxelizeWords& words) {
  OptionRow row = OutputRow(OutputExtensions(), words.options.outputs, /*several=*/true);
  if (words.shape.is_for_memory) {
    row.help = absl::StrCat("Path or URL of an output, or a list of them: ", absl::StrJoin(OutputExtensions(), " "));
    row.standard = "none";
  } else {
    row.help +=
        "; - is standard output. Without it, MESH's name with .vdb in the current folder, or no file with "
        "--json or --verify";
  }
  row.group = "Output";
  row.required = false;
  const auto wrong = row.checks.front().wrong;
  row.checks.front().wrong = [wrong](const std::string& path) {
    return path == kStandardOutput ? WrongWord("") : wrong(path);
  };
  return row;
}

Rows OutputRows(VoxelizeWords& words) {
  Rows rows = ShapeRows(words.shape);
  rows.insert(rows.begin(), VoxelOutputRow(words));
  return rows;
}

Rows LatticeRows(VoxelizeWords& words) {
  return {
      {.names = "--lattice",
       .target = &words.lattice,
       .help = "Named lattice",
       .group = "Lattice",
       .words = WordsOf(LatticeNames()),
       .word_help = {"cubes", "body-centered cubic", "face-centered cubic", "layers of hexagons"},
       .standard = "cartesian"},
      {.names = "--basis",
       .target = &words.basis,
       .help = "Three basis vectors a, b, c of any lattice, in world units; --voxel-size and --resolution rescale them",
       .value = "a1,a2,a3,b1,...,c3",
       .checks = {{CheckNumbers<double, 9>}}},
      {.names = "--voxel-size",
       .target = &words.voxel_size,
       .help =
           "Edge of a cube that has a voxel's volume, in world units; three numbers stretch the lattice along x, y, z",
       .value = "S|SX,SY,SZ",
       .checks = {{CheckVoxelSize}}},
      {.names = "--resolution",
       .aliases = "--res",
       .target = &words.resolution,
       .help = "Voxels along the mesh's longest side",
       .value = "N",
       .checks = {Whole(kMinResolution, kMaxResolution)},
       .standard =
           absl::StrCat(kDefaultResolution, ", or what fits into --dims, without --voxel-size, --basis or --align")},
      {.names = "--origin",
       .target = &words.origin,
       .help = "World position of lattice point 0",
       .value = "X,Y,Z",
       .checks = {{CheckNumbers<double, 3>}},
       .standard = "low corner of the mesh; with cells, half a voxel above it"},
      {.names = "--placement",
       .target = &words.placement,
       .help = "Whether N points span the mesh's longest side from end to end, or N cells divide it",
       .words = WordsOf(PlacementNames()),
       .word_help = {"the first point is the low corner", "the first point is half a voxel above it"},
       .standard = "cells with an interior, otherwise points"},
      {.names = "--align",
       .target = &words.options.align,
       .help = "Use the lattice and origin of this file's grid",
       .value = "FILE.vdb",
       .checks = {{CheckIsHere}}}};
}

Rows SurfaceRows(VoxelizeWords& words) {
  return {{.names = "--separability",
           .target = &words.separability,
           .help = "Strength of separation, 0 strongest; on cartesian 26, 18, 6 are other names of 0, 1, 2",
           .words = {"0", "1", "2", "26", "18", "6"},
           .word_help = {"no path through faces, edges or corners", "no path through faces or edges",
                         "no path through faces", "0", "1", "2"},
           .standard = "0"},
          {.names = "--minimal,!--no-minimal",
           .target = &words.minimal,
           .help = "Remove every voxel that separation does not need (default), or keep them"},
          {.names = "--algorithm",
           .target = &words.algorithm,
           .help = "Algorithm; the others exist for comparison",
           .words = WordsOf(AlgorithmNames()),
           .word_help = {"k-separating and k-minimal", "the thesis's, chapter 4", "the thesis's, chapter 4",
                         "the thesis's, chapter 4"},
           .standard = "exact"}};
}

Rows VoxelRows(VoxelizeWords& words) {
  Rows rows = SetRows(words);
  rows.front().group = "Voxels";
  return rows;
}

Rows VerifyRows(VoxelizeWords& words) {
  return {{.names = "--verify",
           .target = &words.options.request.verify,
           .help = "Count tunnels and redundant voxels with an independent check"}};
}

Rows TransferRows(VoxelizeWords& words) {
  return {
      {.names = "--upload",
       .target = &words.upload,
       .help = "Form of the mesh on its way to the server; auto is draco where a network is in between, otherwise raw",
       .group = "Transfer",
       .words = WordsOf(UploadNames()),
       .word_help = {"raw for a private server, a Unix socket and loopback", "plain arrays, exact",
                     "compressed by Draco, for networks"},
       .standard = "auto"},
      {.names = "--quantization",
       .target = &words.quantization,
       .help = "Bits of a position's coordinate in a Draco stream, 0 (exact) to 30; auto is fine enough for the "
               "resolution",
       .value = "auto|BITS",
       .checks = {{CheckQuantization}},
       .standard = "auto"},
      {.names = "--encoding",
       .target = &words.encoding,
       .help = "Encoding of voxels in the response; packed-zstd suits networks below 1 Gbit/s",
       .words = WordsOf(EncodingNames()),
       .word_help = {"compact and fast", "smaller, for slow networks", "512 bits per brick"},
       .standard = "packed"}};
}

Rows PartRows(VoxelizeWords& words) {
  return {{.names = "--region",
           .target = &words.region,
           .help = "Only the voxels with i0 <= i < i1, j0 <= j < j1, k0 <= k < k1, exactly as in the whole",
           .value = "i0,j0,k0,i1,j1,k1",
           .group = "Part of the whole",
           .checks = {{CheckRegion}}},
          {.names = "--bounds",
           .target = &words.bounds,
           .help = "Only the voxels whose centers lie in this box, faces included",
           .value = "x0,y0,z0,x1,y1,z1",
           .checks = {{CheckBounds}}},
          {.names = "--shard",
           .target = &words.shard,
           .help = "Only part I of N, 0 <= I < N; the parts cost the same and together make the whole",
           .value = "I/N",
           .checks = {{CheckShard}}}};
}

Rows RequestMeshRows(VoxelizeWords& words) {
  Rows rows = MeshRows(words);
  rows.front().group = "Mesh";
  rows.push_back({.names = "--weld-report",
                  .target = &words.options.weld_report,
                  .help = "Count duplicate vertices, degenerate triangles, open edges and non-manifold edges"});
  return rows;
}

// A request has one field for both options.
const OptionPairs& OneOrTheOther() {
  static const auto* const kPairs =
      new OptionPairs{{"--basis", "--lattice"},        {"--align", "--lattice"},    {"--align", "--basis"},
                      {"--align", "--voxel-size"},     {"--align", "--resolution"}, {"--align", "--origin"},
                      {"--resolution", "--voxel-size"}};
  return *kPairs;
}

}  // namespace

void AddRequestOptions(CommandParser& command, VoxelizeWords& words) {
  for (const auto rows :
       {OutputRows, LatticeRows, VoxelRows, SurfaceRows, VerifyRows, TransferRows, PartRows, RequestMeshRows}) {
    command.Add(rows(words));
  }
  command.Exclude(OneOrTheOther());
}

}  // namespace latvox::client
