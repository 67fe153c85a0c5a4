#include "tests/bench/arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"

namespace latvox {
namespace {

const std::map<std::string, NamedLattice>& Lattices() {
  static const auto* const lattices = [] {
    auto* all = new std::map<std::string, NamedLattice>;
    for (const auto& row : kNamedLattices) all->emplace(row.name, row.lattice);
    return all;
  }();
  return *lattices;
}

// Options whose type differs from that of their value in Arguments.
struct Words {
  std::string algorithm = "exact", simd = "best", set, rule = "parity", side = "both";
  bool minimal = true, labels = false;
  std::vector<std::string> fields;
  std::vector<int32_t> region;
  std::vector<double> bounds;
  std::vector<uint32_t> shard;
  double band = 0, close = 0;
  std::vector<double> seed;
  VoxelizeOptions options;
};

template <class Names>
CLI::IsMember OneOf(const Names& names) {
  std::vector<std::string> words;
  words.reserve(names.size());
  for (const auto& [value, name] : names) words.emplace_back(name);
  return CLI::IsMember(words);
}

std::vector<std::string> FieldNames() {
  std::vector<std::string> names;
  for (const FieldFacts& row : kFields) names.emplace_back(row.name);
  return names;
}

const std::map<std::string, LinkSide> kSides{
    {"both", LinkSide::kBoth}, {"inside", LinkSide::kInside}, {"outside", LinkSide::kOutside}};

SetOption SetOf(const Words& words) {
  if (words.band > 0) return Band{.width = words.band, .in_voxels = true};
  if (words.set == "supercover") return SupercoverSurface{};
  if (words.set == "enclosed") return Enclosed{.close = words.close};
  if (words.set == "region" && words.seed.size() == 3) {
    return Connected{{words.seed[0], words.seed[1], words.seed[2]}, words.close, true};
  }
  if (words.set == "links") return Links{kSides.at(words.side)};
  if (words.set != "solid" && words.set != "interior") return SeparatingSurface{};
  return Solid{.rule = words.rule == "parity" ? InteriorRule::kParity : InteriorRule::kWinding,
               .surface = words.set == "solid" ? SolidSurface::kSeparating : SolidSurface::kNone};
}

void Declare(CLI::App& app, Arguments& arguments, Words& words) {
  VoxelizeOptions& options = words.options;
  app.add_option(
      "MESH", arguments.mesh,
      "box, sphere:N (about N triangles), wires:N (N thin wires), ground, forest:N (N tetrahedra), tangle:N, fan:N, "
      "cylinder:N, gears, plates, honeycomb, threads, pipes, city, shells, tree, or a file: .drc .obj .ply .stl .glb "
      ".gltf .3ds");
  app.add_option("RESOLUTION", arguments.resolution, "voxels along the longest side")
      ->check(CLI::Range(uint32_t{2}, kMaxResolution));
  app.add_option("--subdivide", arguments.subdivide, "how often each triangle is divided into four")
      ->check(CLI::Range(0, 8));
  app.add_option("--copies", arguments.copies, "copies of the mesh, each a part")->check(CLI::Range(1, 1000));
  CLI::Option* lattice = app.add_option("--lattice", arguments.lattice)->check(CLI::IsMember(Lattices()));
  app.add_option("--basis", arguments.basis, "three basis vectors")->delimiter(',')->expected(9)->excludes(lattice);
  app.add_option("--separability", options.separability)->check(CLI::Range(0, 2));
  app.add_flag("--minimal,!--no-minimal", words.minimal);
  app.add_option("--region", words.region, "i0,j0,k0,i1,j1,k1: only these lattice points")->delimiter(',')->expected(6);
  app.add_option("--bounds", words.bounds, "x0,y0,z0,x1,y1,z1: only voxels with their centers in this box")
      ->delimiter(',')
      ->expected(6);
  app.add_option("--shard", words.shard, "I/N: only part I, from 0, of N")->delimiter('/')->expected(2);
  app.add_option("--band", words.band, "a band, this many voxel sizes wide")->check(CLI::PositiveNumber);
  app.add_option("--algorithm", words.algorithm)->check(OneOf(kAlgorithms));
  app.add_option("--set", words.set)
      ->check(CLI::IsMember({"surface", "supercover", "solid", "interior", "enclosed", "region", "links"}));
  app.add_option("--close", words.close, "for --set enclosed or region: holes up to this width are closed, world units")
      ->check(CLI::PositiveNumber);
  app.add_option("--seed", words.seed, "x,y,z: where --set region begins")->delimiter(',')->expected(3);
  app.add_option("--rule", words.rule, "which points are inside a solid")->check(CLI::IsMember({"parity", "winding"}));
  app.add_flag("--labels", words.labels, "make a solid or an enclosed set of each part, and let voxels carry the part");
  app.add_option("--side", words.side, "which ends of links")->check(CLI::IsMember(kSides));
  app.add_option("--fields", words.fields, "what voxels carry; default: distance for a band, otherwise nothing")
      ->delimiter(',')
      ->check(CLI::IsMember(FieldNames()));
  app.add_flag("--signed", options.signed_distance, "distances are negative inside");
  app.add_option("--fraction-n", options.fraction_n,
                 "with --fields fraction or label_fractions: points along each axis of a cell");
  app.add_option("--simd", words.simd, "kernels")->check(OneOf(kSimdNames));
  app.add_option("--threads", arguments.threads)->check(CLI::Range(1, kMaxThreads));
  app.add_option("--warmups", arguments.warmups, "repetitions before the clock")->check(CLI::Range(0, 1000));
  app.add_option("--reps", arguments.reps, "repetitions")->check(CLI::Range(1, 1000));
  app.add_option("--peer", arguments.peer, "time another program instead")->check(CLI::IsMember({"openvdb", "recast"}));
  app.add_flag("--discard", arguments.discard, "drop bricks as they arrive");
  app.add_flag("--cancel", arguments.cancel, "also measure cancellation");
  app.add_flag("--json", arguments.json);
}

// Refuses options that do not go together.
absl::Status CheckTogether(const CLI::App& app, const Words& named, const Arguments& arguments) {
  const VoxelizeOptions& options = named.options;
  const std::pair<const char*, bool> ours[] = {{"--lattice", arguments.lattice != "cartesian"},
                                               {"--basis", !arguments.basis.empty()},
                                               {"--region", !named.region.empty()},
                                               {"--bounds", !named.bounds.empty()},
                                               {"--shard", !named.shard.empty()},
                                               {"--algorithm", options.algorithm != Algorithm::kExact},
                                               {"--set", !named.set.empty()},
                                               {"--fields", !named.fields.empty()}};
  for (const auto& [option, is_given] : ours) {
    if (!arguments.peer.empty() && is_given) {
      return absl::InvalidArgumentError(absl::StrCat("--peer: ", arguments.peer, " has no equivalent of ", option));
    }
  }
  if (arguments.peer == "recast" && named.band > 0) {
    return absl::InvalidArgumentError("--peer: recast has no equivalent of --band");
  }
  if (!std::holds_alternative<Solid>(options.set) && app.count("--rule") > 0) {
    return absl::InvalidArgumentError("--rule: needs --set solid or interior");
  }
  if ((named.set == "region") != !named.seed.empty()) {
    return absl::InvalidArgumentError("--seed: goes with --set region, and with no other set");
  }
  if (named.close > 0 && named.set != "enclosed" && named.set != "region") {
    return absl::InvalidArgumentError("--close: needs --set enclosed or region");
  }
  if (!std::holds_alternative<Links>(options.set) && app.count("--side") > 0) {
    return absl::InvalidArgumentError("--side: needs --set links");
  }
  if (named.band > 0 && !named.set.empty()) return absl::InvalidArgumentError("--band: is a set, as --set is");
  return absl::OkStatus();
}

constexpr char kUsage[] =
    "Times the voxelizer, memory to memory: latvox_bench MESH RESOLUTION [OPTIONS].\n"
    "`latvox_bench -` reads the arguments of one measurement from each line of standard input.";

}  // namespace

absl::StatusOr<Arguments> ParseArguments(std::vector<std::string> words) {
  Arguments arguments;
  Words named;
  CLI::App app;
  Declare(app, arguments, named);
  std::reverse(words.begin(), words.end());  // in CLI11's form
  try {
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    arguments.help = true;
    return arguments;
  } catch (const CLI::ParseError& error) {
    return absl::InvalidArgumentError(error.what());
  }
  if (arguments.resolution == 0) return absl::InvalidArgumentError("MESH and RESOLUTION are required; see --help");
  VoxelizeOptions& options = named.options;
  options.algorithm = *AlgorithmNamed(named.algorithm);
  options.set = SetOf(named);
  for (const std::string& name : named.fields) {
    options.fields.Add(std::ranges::find(kFields, name, &FieldFacts::name)->field);
  }
  if (named.labels) {
    if (auto* const solid = std::get_if<Solid>(&options.set)) {
      solid->labels = Field::kPart;
    } else if (auto* const enclosed = std::get_if<Enclosed>(&options.set)) {
      enclosed->labels = Field::kPart;
    } else {
      return absl::InvalidArgumentError("--labels: needs --set solid, interior or enclosed");
    }
    if (!options.fields.Contains(Field::kPart)) options.fields.Add(Field::kPart);
  }
  if (named.band > 0 && named.fields.empty()) options.fields = {Field::kDistance};
  arguments.simd = *SimdNamed(named.simd);
  if (auto status = CheckTogether(app, named, arguments); !status.ok()) return status;
  if (app.count("--minimal") > 0) options.minimal = named.minimal;
  if (const auto& r = named.region; !r.empty()) options.region = {{r[0], r[1], r[2]}, {r[3], r[4], r[5]}};
  if (const auto& b = named.bounds; !b.empty()) options.bounds = {{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
  if (const auto& shard = named.shard; !shard.empty()) options.shard = {shard[0], shard[1]};
  absl::StatusOr<VoxelRequest> request = MakeRequest(options);
  if (!request.ok()) return request.status();
  arguments.request = *std::move(request);
  return arguments;
}

std::string Help() {
  CLI::App app(kUsage, "latvox_bench");
  Arguments arguments;
  Words words;
  Declare(app, arguments, words);
  return app.help();
}

absl::StatusOr<Lattice> LatticeOf(const Arguments& arguments) {
  if (arguments.basis.empty()) return Lattice::Named(Lattices().at(arguments.lattice));
  const auto& b = arguments.basis;
  return Lattice::FromBasis({{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}, {b[6], b[7], b[8]}}});
}

}  // namespace latvox
