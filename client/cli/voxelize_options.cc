#include "client/cli/voxelize_options.h"

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "client/cli/common_options.h"
#include "client/mesh/mesh_encoder.h"
#include "client/output/output.h"

namespace latvox::client {
namespace {

const Names<NamedLattice>& LatticeNames() {
  static const auto* const kNames = new Names<NamedLattice>{{"cartesian", NamedLattice::kCartesian},
                                                            {"bcc", NamedLattice::kBcc},
                                                            {"fcc", NamedLattice::kFcc},
                                                            {"hexagonal", NamedLattice::kHexagonal}};
  return *kNames;
}

const Names<Algorithm>& AlgorithmNames() {
  static const auto* const kNames = new Names<Algorithm>{{"exact", Algorithm::kExact},
                                                         {"brute-force", Algorithm::kBruteForce},
                                                         {"incremental", Algorithm::kIncremental},
                                                         {"optimized-incremental", Algorithm::kOptimizedIncremental}};
  return *kNames;
}

const Names<BrickEncoding>& EncodingNames() {
  static const auto* const kNames = new Names<BrickEncoding>{{"packed", BrickEncoding::kPacked},
                                                             {"packed-zstd", BrickEncoding::kPackedZstd},
                                                             {"masks", BrickEncoding::kMasks}};
  return *kNames;
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

// 26, 18 and 6 count a voxel's neighbours, which is what they do on the Cartesian lattice only.
uint32_t InterpretSeparability(int given, const std::variant<NamedLattice, Basis>& lattice) {
  if (given <= 2) return static_cast<uint32_t>(given);
  if (lattice != std::variant<NamedLattice, Basis>(NamedLattice::kCartesian)) {
    Refuse("--separability: ", given, " is for --lattice cartesian; elsewhere 0, 1 or 2");
  }
  return given == 26 ? 0 : given == 18 ? 1 : 2;
}

void CheckCarryDistances(const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs) {
    if (!CarriesDistances(output)) {
      Refuse("--band: ", output, " cannot hold distances; ", absl::StrJoin(DistanceExtensions(), " "), " can");
    }
  }
}

}  // namespace

void AddRequestOptions(CLI::App& command, VoxelizeWords& words) {
  VoxelizeOptions& options = words.options;
  AddOutputOption(command, OutputExtensions(), options.outputs);
  CLI::Option* lattice =
      command.add_option("--lattice", words.lattice, "default: cartesian")->check(OneOf(LatticeNames()));
  command.add_option("--basis", words.basis, "three basis vectors a, b, c of any lattice, world units")
      ->type_name("a1,a2,a3,b1,...,c3")
      ->check(CheckNumbers<double, 9>)
      ->excludes(lattice);
  CLI::Option* voxel_size =
      command.add_option("--voxel-size", words.voxel_size, "edge of a cube with a voxel's volume, world units")
          ->type_name("S")
          ->check(CheckPositive);
  command.add_option("--resolution", words.resolution, "voxels along the mesh's longest side, 2 to 65536")
      ->type_name("N")
      ->check(Whole(kMinResolution, kMaxResolution))
      ->excludes(voxel_size);
  command.add_option("--origin", words.origin, "world position of lattice point 0 (default: the mesh's low corner)")
      ->type_name("X,Y,Z")
      ->check(CheckNumbers<double, 3>);
  command
      .add_option("--separability", words.separability, "0 (strongest, the default), 1, 2; on cartesian also 26, 18, 6")
      ->type_name("K")
      ->check(CLI::IsMember({0, 1, 2, 26, 18, 6}));
  command.add_flag("--minimal,!--no-minimal", options.request.minimal, "remove every voxel that can go (default)");
  command.add_option("--algorithm", words.algorithm, "default: exact; the others are there to compare with")
      ->check(OneOf(AlgorithmNames()));
  command.add_option("--fill", words.fill)->check(CLI::IsMember({"surface"}));
  command.add_option("--cover", words.cover)->check(CLI::IsMember({"separating"}));
  command
      .add_option("--quantization", words.quantization,
                  "position bits of the upload, 0 (exact) to 30; auto: fine enough for the resolution")
      ->type_name("auto|0..30")
      ->check(CheckQuantization);
  CLI::Option* verify =
      command.add_flag("--verify", options.request.verify, "count tunnels and redundant voxels independently");
  command.add_option("--region", words.region, "only the voxels i0 <= i < i1 and so on, exactly as in the whole")
      ->type_name("i0,j0,k0,i1,j1,k1")
      ->check(CheckRegion)
      ->excludes(verify);
  command.add_option("--shard", words.shard, "only part I, from 0, of N parts of equal cost that make the whole")
      ->type_name("I/N")
      ->check(CheckShard)
      ->excludes(verify);
  CLI::Option* band =
      command
          .add_option("--band", words.band, "not a surface: all voxels up to W away, or W voxel sizes, with distances")
          ->type_name("W|Wv")
          ->check(CheckBand);
  for (const char* other : {"--separability", "--algorithm", "--fill", "--cover", "--verify"}) {
    band->excludes(command.get_option(other));
  }
  command.add_flag("--signed", words.is_signed, "distances are negative inside; the mesh must be closed")->needs(band);
  command.add_option("--encoding", words.encoding, "of voxels under way; packed-zstd: for networks below 1 Gbit/s")
      ->check(OneOf(EncodingNames()));
}

void AddVoxelizeOptions(CLI::App& command, VoxelizeWords& words) {
  VoxelizeOptions& options = words.options;
  command.add_option("mesh", options.mesh, "mesh file: .drc .obj .ply .stl .glb .gltf")->type_name("MESH")->required();
  AddRequestOptions(command, words);
  command.add_flag("--json", options.json, "machine-readable summary on standard output");
  AddServerOptions(command, options.server);
}

VoxelizeOptions InterpretRequest(const VoxelizeWords& words) {
  VoxelizeOptions options = words.options;
  VoxelizeRequest& request = options.request;
  request.lattice = InterpretLattice(words);
  request.algorithm = ValueNamed(AlgorithmNames(), words.algorithm);
  request.encoding = ValueNamed(EncodingNames(), words.encoding);
  request.separability = InterpretSeparability(words.separability, request.lattice);
  if (!words.voxel_size.empty()) ParseNumber(words.voxel_size, request.voxel_size.emplace());
  if (!words.resolution.empty()) ParseNumber(words.resolution, request.resolution.emplace());
  if (!words.origin.empty()) ParseNumbers(words.origin, request.origin.emplace());
  if (!words.region.empty()) {
    std::array<int32_t, 6> n{};
    ParseNumbers(words.region, n);
    request.region = IndexBox{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  }
  if (!words.shard.empty()) request.shard = ParseShard(words.shard);
  if (!words.band.empty()) {
    request.band = ParseBand(words.band);
    request.band->is_signed = words.is_signed;
    CheckCarryDistances(options.outputs);
  }
  if (words.quantization != "auto") ParseNumber(words.quantization, options.quantization_bits.emplace());
  if (words.basis.empty() && !request.voxel_size && !request.resolution) {
    Refuse("--voxel-size or --resolution is required for a named lattice");
  }
  return options;
}

VoxelizeOptions Interpret(const VoxelizeWords& words) {
  VoxelizeOptions options = InterpretRequest(words);
  CheckOutputs(options.outputs, options.mesh, "mesh");
  return options;
}

}  // namespace latvox::client
