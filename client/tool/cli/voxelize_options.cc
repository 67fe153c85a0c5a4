#include "client/tool/cli/voxelize_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/mesh/mesh_encoder.h"
#include "client/tool/cli/attributes_option.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/output/box_output.h"
#include "client/tool/output/output.h"
#include "latvox/stretched.h"

namespace latvox::client {
namespace {

const Names<NamedLattice>& LatticeNames() {
  static const auto* const kNames = new Names<NamedLattice>(NamesOfLattices(kNamedLattices));
  return *kNames;
}

const Names<Algorithm>& AlgorithmNames() {
  static const auto* const kNames = new Names<Algorithm>{{"exact", Algorithm::kExact},
                                                         {"brute-force", Algorithm::kBruteForce},
                                                         {"incremental", Algorithm::kIncremental},
                                                         {"optimized-incremental", Algorithm::kOptimizedIncremental}};
  return *kNames;
}

const Names<InteriorRule>& RuleNames() {
  static const auto* const kNames =
      new Names<InteriorRule>{{"parity", InteriorRule::kParity}, {"winding", InteriorRule::kWinding}};
  return *kNames;
}

const Names<Cover>& CoverNames() {
  static const auto* const kNames =
      new Names<Cover>{{"separating", Cover::kSeparating}, {"supercover", Cover::kSupercover}};
  return *kNames;
}

const Names<BrickEncoding>& EncodingNames() {
  static const auto* const kNames = new Names<BrickEncoding>{{"packed", BrickEncoding::kPacked},
                                                             {"packed-zstd", BrickEncoding::kPackedZstd},
                                                             {"masks", BrickEncoding::kMasks}};
  return *kNames;
}

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

std::variant<NamedLattice, Basis> InterpretLattice(const VoxelizeWords& words) {
  if (!words.basis.empty()) {
    std::array<double, 9> n{};
    ParseNumbers(words.basis, n);
    return Basis{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}};
  }
  return ValueNamed(LatticeNames(), words.lattice);
}

// One size, or one for each axis.
void InterpretVoxelSize(const VoxelizeWords& words, VoxelizeRequest& request) {
  const std::string& text = words.voxel_size;
  Vec3d sizes;
  if (text.empty()) return;
  if (!ParseNumbers(text, sizes)) {
    ParseNumber(text, request.voxel_size.emplace());
  } else if (!words.basis.empty()) {
    Refuse("--voxel-size: only one number goes with --basis, not ", text);
  } else if (sizes[0] == sizes[1] && sizes[0] == sizes[2]) {
    request.voxel_size = sizes[0];
  } else {
    request.lattice = Stretched(std::get<NamedLattice>(request.lattice), sizes);
  }
}

// Of a grid to align to, the lattice is known only once its file is read.
void CheckCubes(const VoxelizeOptions& options) {
  const std::variant<NamedLattice, Basis>& lattice = options.request.lattice;
  const Basis* basis = std::get_if<Basis>(&lattice);
  if (basis != nullptr ? IsCubic(*basis) : std::get<NamedLattice>(lattice) == NamedLattice::kCartesian) return;
  for (const std::string& output : options.outputs) {
    if (HasExtension(output, {".binvox", ".vox"})) Refuse("--out: ", output, ": ", kCubesOnly);
  }
}

// "W" or "Wv"; nothing if it is neither.
std::optional<Band> ParseBand(absl::string_view text) {
  Band band;
  band.in_voxels = absl::ConsumeSuffix(&text, "v");
  if (!ParseNumber(text, band.width) || !(band.width > 0)) return std::nullopt;
  return band;
}

std::string CheckBand(const std::string& text) {
  if (ParseBand(text)) return "";
  return absl::StrCat("\"", text, "\" is not a finite number above 0, or one with v for voxel sizes");
}

// 26, 18 and 6 count a voxel's neighbours, which is what they do on the Cartesian lattice only. Of a grid to align to,
// the lattice may be any.
uint32_t InterpretSeparability(const VoxelizeWords& words, const std::variant<NamedLattice, Basis>& lattice) {
  const int given = words.separability;
  if (given <= 2) return static_cast<uint32_t>(given);
  if (!words.options.align.empty() || lattice != std::variant<NamedLattice, Basis>(NamedLattice::kCartesian)) {
    Refuse("--separability: ", given, " is for --lattice cartesian; elsewhere 0, 1 or 2");
  }
  return given == 26 ? 0 : given == 18 ? 1 : 2;
}

void AddFillOptions(CLI::App& command, VoxelizeWords& words) {
  command.add_option("--fill", words.fill, "surface (default), or solid: what is inside of a closed mesh, too")
      ->check(CLI::IsMember({"surface", "solid"}));
  command
      .add_option("--interior-rule", words.interior_rule,
                  "what is inside: parity (default), or winding, which makes bodies that overlap one")
      ->check(OneOf(RuleNames()));
  command.add_flag("--without-surface", words.without_surface, "of a solid only voxels whose centre is inside");
  command.add_flag("--force-open", words.force_open,
                   "fill a mesh that is not closed, but for lattice lines along k that end unbalanced");
}

// What repeats the mesh as it is asked for.
MeshNote NoteOf(const VoxelizeOptions& options, const VoxelizeWords& words) {
  MeshNote note;
  note.up_axis = words.up_axis;
  if (!words.scale.empty()) note.scale = options.mesh.scale;
  note.input_format = words.input_format;
  note.quantization = options.quantization_bits;
  return note;
}

std::optional<Solid> InterpretSolid(const VoxelizeWords& words) {
  if (words.fill == "solid") {
    if (words.options.request.verify) Refuse("--verify: is for --fill surface");
    return Solid{ValueNamed(RuleNames(), words.interior_rule), !words.without_surface, words.force_open};
  }
  if (!words.interior_rule.empty()) Refuse("--interior-rule: needs --fill solid");
  if (words.without_surface) Refuse("--without-surface: needs --fill solid");
  if (words.force_open) Refuse("--force-open: needs --fill solid");
  return std::nullopt;
}

}  // namespace

void AddRequestOptions(CLI::App& command, VoxelizeWords& words) {
  VoxelizeOptions& options = words.options;
  Group(command, "Output");
  AddOutputOption(command, OutputExtensions(), options.outputs);
  command
      .add_option("--npy", words.npy, "what a .npy holds: a row of coordinates a voxel (default), or a box of 0 and 1")
      ->check(CLI::IsMember({"coordinates", "dense"}));
  Group(command, "Lattice");
  CLI::Option* lattice =
      command.add_option("--lattice", words.lattice, "default: cartesian")->check(OneOf(LatticeNames()));
  command
      .add_option("--basis", words.basis,
                  "three basis vectors a, b, c of any lattice, world units; only their shape, with --voxel-size or "
                  "--resolution")
      ->type_name("a1,a2,a3,b1,...,c3")
      ->check(CheckNumbers<double, 9>)
      ->excludes(lattice);
  CLI::Option* voxel_size =
      command
          .add_option("--voxel-size", words.voxel_size,
                      "edge of a cube with a voxel's volume, world units; or the lattice stretched along x, y, z")
          ->type_name("S|SX,SY,SZ")
          ->check(CheckVoxelSize);
  command.add_option("--resolution", words.resolution, "voxels along the mesh's longest side, 2 to 65536")
      ->type_name("N")
      ->check(Whole(kMinResolution, kMaxResolution))
      ->excludes(voxel_size);
  command.add_option("--origin", words.origin, "world position of lattice point 0 (default: the mesh's low corner)")
      ->type_name("X,Y,Z")
      ->check(CheckNumbers<double, 3>);
  CLI::Option* align =
      command.add_option("--align", options.align, "on the lattice and origin of this .vdb file's grid")
          ->type_name("FILE.vdb");
  for (const char* other : {"--lattice", "--basis", "--voxel-size", "--resolution", "--origin"}) {
    align->excludes(command.get_option(other));
  }
  Group(command, "Voxels");
  command
      .add_option("--separability", words.separability, "0 (strongest, the default), 1, 2; on cartesian also 26, 18, 6")
      ->type_name("K")
      ->check(CLI::IsMember({0, 1, 2, 26, 18, 6}));
  command.add_flag("--minimal,!--no-minimal")
      ->description("remove every voxel that can go (default)")
      ->check(CLI::IsMember({"true", "false"}))
      ->each([&words](const std::string& flag) { words.minimal = flag == "true"; });
  command.add_option("--algorithm", words.algorithm, "default: exact; the others are there to compare with")
      ->check(OneOf(AlgorithmNames()));
  AddFillOptions(command, words);
  command
      .add_option("--cover", words.cover, "separating (default), or supercover: all voxels whose cell meets the mesh")
      ->check(OneOf(CoverNames()));
  for (const char* of_surface : {"--separability", "--minimal", "--cover"}) {
    command.get_option("--without-surface")->excludes(command.get_option(of_surface));
  }
  Group(command, "Transfer");
  command
      .add_option("--quantization", words.quantization,
                  "position bits of the upload, 0 (exact) to 30; auto: fine enough for the resolution")
      ->type_name("auto|0..30")
      ->check(CheckQuantization);
  Group(command, "Voxels");
  CLI::Option* verify =
      command.add_flag("--verify", options.request.verify, "count tunnels and redundant voxels independently");
  Group(command, "Part of the whole");
  command.add_option("--region", words.region, "only the voxels i0 <= i < i1 and so on, exactly as in the whole")
      ->type_name("i0,j0,k0,i1,j1,k1")
      ->check(CheckRegion)
      ->excludes(verify);
  command.add_option("--bounds", words.bounds, "only the voxels whose centres lie in this box, faces included")
      ->type_name("x0,y0,z0,x1,y1,z1")
      ->check(CheckBounds)
      ->excludes(verify);
  command.add_option("--shard", words.shard, "only part I, from 0, of N parts of equal cost that make the whole")
      ->type_name("I/N")
      ->check(CheckShard)
      ->excludes(verify);
  Group(command, "Voxels");
  CLI::Option* band =
      command
          .add_option("--band", words.band, "not a surface: all voxels up to W away, or W voxel sizes, with distances")
          ->type_name("W|Wv")
          ->check(CheckBand);
  for (const char* other : {"--separability", "--minimal", "--algorithm", "--fill", "--cover", "--verify"}) {
    band->excludes(command.get_option(other));
  }
  command.add_flag("--signed", words.is_signed, "distances are negative inside; the mesh must be closed")->needs(band);
  AddAttributesOption(command, words);
  Group(command, "Transfer");
  command.add_option("--encoding", words.encoding, "of voxels under way; packed-zstd: for networks below 1 Gbit/s")
      ->check(OneOf(EncodingNames()));
  Group(command, "Mesh");
  AddMeshOptions(command, words);
  command.add_flag("--weld-report", options.weld_report,
                   "count duplicate vertices, degenerate triangles, open and non-manifold edges");
}

void AddVoxelizeOptions(CLI::App& command, VoxelizeWords& words) {
  VoxelizeOptions& options = words.options;
  AddMeshes(command, options.mesh);
  AddRequestOptions(command, words);
  Group(command, "Output");
  command.add_flag("--json", options.json, "machine-readable summary on standard output");
  AddServerOptions(command, options.server);
}

VoxelizeOptions InterpretRequest(const VoxelizeWords& words) {
  VoxelizeOptions options = words.options;
  VoxelizeRequest& request = options.request;
  request.lattice = InterpretLattice(words);
  request.algorithm = ValueNamed(AlgorithmNames(), words.algorithm);
  request.cover = ValueNamed(CoverNames(), words.cover);
  request.minimal = words.minimal;
  if (request.cover == Cover::kSupercover && request.minimal == true) {
    Refuse("--minimal excludes --cover supercover, which is not thinned");
  }
  if (request.cover == Cover::kSupercover && request.algorithm != Algorithm::kExact) {
    Refuse("--cover supercover excludes --algorithm ", words.algorithm);
  }
  if (words.minimal == true && request.algorithm != Algorithm::kExact) {
    Refuse("--minimal excludes --algorithm ", words.algorithm, ", which is not thinned");
  }
  request.encoding = ValueNamed(EncodingNames(), words.encoding);
  request.solid = InterpretSolid(words);
  if (request.solid && request.algorithm != Algorithm::kExact) Refuse("--fill: solid is for --algorithm exact");
  request.separability = InterpretSeparability(words, request.lattice);
  InterpretVoxelSize(words, request);
  CheckCubes(options);
  if (!words.resolution.empty()) ParseNumber(words.resolution, request.resolution.emplace());
  if (!words.origin.empty()) ParseNumbers(words.origin, request.origin.emplace());
  if (!words.region.empty()) {
    std::array<int32_t, 6> n{};
    ParseNumbers(words.region, n);
    request.region = IndexBox{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  }
  if (!words.bounds.empty()) {
    std::array<double, 6> n{};
    ParseNumbers(words.bounds, n);
    request.bounds = WorldBox{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  }
  const auto is_npy = [](const std::string& path) { return absl::EndsWithIgnoreCase(path, ".npy"); };
  if (!words.npy.empty() && std::none_of(options.outputs.begin(), options.outputs.end(), is_npy)) {
    Refuse("--npy: ", words.npy, " is of a .npy, and no --out is one");
  }
  options.output_options.dense_npy = words.npy == "dense";
  InterpretMesh(words, options.mesh);
  if (!words.up_axis.empty()) options.output_options.picture_up = UpAxis::kZ;
  if (!words.shard.empty()) request.shard = ParseShard(words.shard);
  if (!words.band.empty()) {
    request.band = ParseBand(words.band);
    request.band->is_signed = words.is_signed;
    if (!words.npy.empty()) Refuse("--npy: ", words.npy, " is of a surface's or a solid's voxels, without --band");
    CheckCarry("--band", "distances", DistanceExtensions(), options.outputs);
  }
  InterpretAttributes(words, options);
  if (words.quantization != "auto") ParseNumber(words.quantization, options.quantization_bits.emplace());
  options.output_options.note = NoteOf(options, words);
  if (words.basis.empty() && options.align.empty() && words.voxel_size.empty() && !request.resolution) {
    Refuse("--voxel-size or --resolution is required for a named lattice");
  }
  return options;
}

VoxelizeOptions Interpret(const VoxelizeWords& words) {
  VoxelizeOptions options = InterpretRequest(words);
  CheckMeshPaths(options.mesh, options.outputs);
  return options;
}

}  // namespace latvox::client
