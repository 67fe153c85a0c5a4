#include "client/tool/cli/request_rows.h"

#include <array>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/mesh/mesh_encoder.h"
#include "client/tool/cli/attributes_option.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/request_words.h"
#include "client/tool/output/output.h"

namespace latvox::client {
namespace {

using Rows = std::vector<OptionRow>;

std::string CheckVoxelSize(const std::string& text) {
  if (!absl::StrContains(text, ',')) return CheckPositive(text);
  Vec3d sizes;
  if (ParseNumbers(text, sizes) && sizes[0] > 0 && sizes[1] > 0 && sizes[2] > 0) return "";
  return absl::StrCat("\"", text, "\" is not one number or three, finite and above 0");
}

std::string CheckRegion(const std::string& text) {
  if (auto error = CheckNumbers<int32_t, 6>(text); !error.empty()) return error;
  std::array<int32_t, 6> box;
  ParseNumbers(text, box);
  for (size_t m = 0; m < 3; ++m) {
    if (box[m] >= box[m + 3]) {
      return absl::StrCat("\"", text, "\" is empty: ", box[m + 3], " does not exceed ", box[m], " on axis ", m);
    }
  }
  return "";
}

std::string CheckBounds(const std::string& text) {
  if (auto error = CheckNumbers<double, 6>(text); !error.empty()) return error;
  std::array<double, 6> box;
  ParseNumbers(text, box);
  for (size_t m = 0; m < 3; ++m) {
    if (box[m] > box[m + 3]) {
      return absl::StrCat("\"", text, "\" is empty: ", box[m + 3], " is below ", box[m], " on axis ", m);
    }
  }
  return "";
}

std::string CheckQuantization(const std::string& text) {
  int64_t bits = 0;
  if (text == "auto" || (ParseNumber(text, bits) && bits >= 0 && bits <= kMaxQuantizationBits)) return "";
  return absl::StrCat("\"", text, "\" is not auto or a whole number from 0 to ", kMaxQuantizationBits);
}

std::string CheckBand(const std::string& text) {
  if (ParseBand(text)) return "";
  return absl::StrCat("\"", text, "\" is not a finite number above 0, or one with v for voxel sizes");
}

Rows OutputRows(VoxelizeWords& words) {
  OptionRow output = OutputRow(OutputExtensions(), words.options.outputs);
  output.group = "Output";
  return {std::move(output),
          {.names = "--npy",
           .target = &words.npy,
           .help = "what a .npy holds: a row of coordinates a voxel (default), or a box of 0 and 1",
           .words = {"coordinates", "dense"}}};
}

Rows LatticeRows(VoxelizeWords& words) {
  return {{.names = "--lattice",
           .target = &words.lattice,
           .help = "default: cartesian",
           .group = "Lattice",
           .words = WordsOf(LatticeNames())},
          {.names = "--basis",
           .target = &words.basis,
           .help = "three basis vectors a, b, c of any lattice, world units; only their shape, with --voxel-size or "
                   "--resolution",
           .value = "a1,a2,a3,b1,...,c3",
           .checks = {{CheckNumbers<double, 9>}}},
          {.names = "--voxel-size",
           .target = &words.voxel_size,
           .help = "edge of a cube with a voxel's volume, world units; or the lattice stretched along x, y, z",
           .value = "S|SX,SY,SZ",
           .checks = {{CheckVoxelSize}}},
          {.names = "--resolution",
           .target = &words.resolution,
           .help = "voxels along the mesh's longest side, 2 to 65536",
           .value = "N",
           .checks = {Whole(kMinResolution, kMaxResolution)}},
          {.names = "--origin",
           .target = &words.origin,
           .help = "world position of lattice point 0 (default: the mesh's low corner)",
           .value = "X,Y,Z",
           .checks = {{CheckNumbers<double, 3>}}},
          {.names = "--align",
           .target = &words.options.align,
           .help = "on the lattice and origin of this .vdb file's grid",
           .value = "FILE.vdb"}};
}

Rows SurfaceRows(VoxelizeWords& words) {
  return {{.names = "--separability",
           .target = &words.separability,
           .help = "0 (strongest, the default), 1, 2; on cartesian also 26, 18, 6",
           .value = "K",
           .group = "Voxels",
           .words = {"0", "1", "2", "26", "18", "6"}},
          {.names = "--minimal,!--no-minimal",
           .target = &words.minimal,
           .help = "remove every voxel that can go (default)"},
          {.names = "--algorithm",
           .target = &words.algorithm,
           .help = "default: exact; the others are there to compare with",
           .words = WordsOf(AlgorithmNames())}};
}

Rows FillRows(VoxelizeWords& words) {
  return {{.names = "--fill",
           .target = &words.fill,
           .help = "surface (default), or solid: what is inside of a closed mesh, too",
           .words = {"surface", "solid"}},
          {.names = "--interior-rule",
           .target = &words.interior_rule,
           .help = "what is inside: parity (default), or winding, which makes bodies that overlap one",
           .words = WordsOf(RuleNames())},
          {.names = "--without-surface",
           .target = &words.without_surface,
           .help = "of a solid only voxels whose centre is inside"},
          {.names = "--force-open",
           .target = &words.force_open,
           .help = "fill a mesh that is not closed, but for lattice lines along k that end unbalanced"}};
}

Rows VoxelRows(VoxelizeWords& words) {
  return {{.names = "--cover",
           .target = &words.cover,
           .help = "separating (default), or supercover: all voxels whose cell meets the mesh",
           .words = WordsOf(CoverNames())},
          {.names = "--verify",
           .target = &words.options.request.verify,
           .help = "count tunnels and redundant voxels independently"},
          {.names = "--band",
           .target = &words.band,
           .help = "not a surface: all voxels up to W away, or W voxel sizes, with distances",
           .value = "W|Wv",
           .checks = {{CheckBand}}},
          {.names = "--signed",
           .target = &words.is_signed,
           .help = "distances are negative inside; the mesh must be closed"},
          AttributesRow(words)};
}

Rows TransferRows(VoxelizeWords& words) {
  return {{.names = "--quantization",
           .target = &words.quantization,
           .help = "position bits of the upload, 0 (exact) to 30; auto: fine enough for the resolution",
           .value = "auto|0..30",
           .group = "Transfer",
           .checks = {{CheckQuantization}}},
          {.names = "--encoding",
           .target = &words.encoding,
           .help = "of voxels under way; packed-zstd: for networks below 1 Gbit/s",
           .words = WordsOf(EncodingNames())}};
}

Rows PartRows(VoxelizeWords& words) {
  return {{.names = "--region",
           .target = &words.region,
           .help = "only the voxels i0 <= i < i1 and so on, exactly as in the whole",
           .value = "i0,j0,k0,i1,j1,k1",
           .group = "Part of the whole",
           .checks = {{CheckRegion}}},
          {.names = "--bounds",
           .target = &words.bounds,
           .help = "only the voxels whose centres lie in this box, faces included",
           .value = "x0,y0,z0,x1,y1,z1",
           .checks = {{CheckBounds}}},
          {.names = "--shard",
           .target = &words.shard,
           .help = "only part I, from 0, of N parts of equal cost that make the whole",
           .value = "I/N",
           .checks = {{CheckShard}}}};
}

Rows RequestMeshRows(VoxelizeWords& words) {
  Rows rows = MeshRows(words);
  rows.front().group = "Mesh";
  rows.push_back({.names = "--weld-report",
                  .target = &words.options.weld_report,
                  .help = "count duplicate vertices, degenerate triangles, open and non-manifold edges"});
  return rows;
}

// Two ways to say one thing, of which a request could hold only one.
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
       {OutputRows, LatticeRows, SurfaceRows, FillRows, VoxelRows, TransferRows, PartRows, RequestMeshRows}) {
    command.Add(rows(words));
  }
  command.Exclude(OneOrTheOther());
  command.Need({{"--signed", "--band"}});
}

// "W" or "Wv"; nothing if it is neither.
std::optional<Band> ParseBand(absl::string_view text) {
  Band band;
  band.in_voxels = absl::ConsumeSuffix(&text, "v");
  if (!ParseNumber(text, band.width) || !(band.width > 0)) return std::nullopt;
  return band;
}

}  // namespace latvox::client
