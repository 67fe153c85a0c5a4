#include "client/cli/voxelize_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <set>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh_encoder.h"
#include "client/output/output.h"

namespace latvox::client {
namespace {

constexpr int kMinResolution = 2, kMaxResolution = 65536, kMaxThreads = 1024;

const std::vector<std::pair<std::string, NamedLattice>>& NamedLattices() {
  static const auto* const kNames =
      new std::vector<std::pair<std::string, NamedLattice>>{{"cartesian", NamedLattice::kCartesian},
                                                            {"bcc", NamedLattice::kBcc},
                                                            {"fcc", NamedLattice::kFcc},
                                                            {"hexagonal", NamedLattice::kHexagonal}};
  return *kNames;
}

template <class T>
bool ParseNumber(absl::string_view text, T& number) {
  text = absl::StripAsciiWhitespace(text);
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return false;
  if constexpr (std::is_floating_point_v<T>) return std::isfinite(number);
  return true;
}

// "1,2,3" as exactly N numbers.
template <class T, size_t N>
bool ParseNumbers(const std::string& text, std::array<T, N>& numbers) {
  const std::vector<absl::string_view> words = absl::StrSplit(text, ',');
  if (words.size() != N) return false;
  for (size_t n = 0; n < N; ++n) {
    if (!ParseNumber(words[n], numbers[n])) return false;
  }
  return true;
}

// CLI11 puts the option's name before what a check returns.
template <class T, size_t N>
std::string CheckNumbers(const std::string& text) {
  std::array<T, N> numbers;
  if (ParseNumbers(text, numbers)) return "";
  const char* kind = std::is_integral_v<T> ? " 32-bit integers" : " finite numbers";
  return absl::StrCat("\"", text, "\" is not ", N, kind, " with commas between them");
}

std::string CheckPositive(const std::string& text) {
  double number = 0;
  if (ParseNumber(text, number) && number > 0) return "";
  return absl::StrCat("\"", text, "\" is not a finite number above 0");
}

CLI::Validator Whole(int low, int high) {
  return CLI::Validator(
      [low, high](const std::string& text) -> std::string {
        int64_t number = 0;
        if (ParseNumber(text, number) && number >= low && number <= high) return "";
        return absl::StrCat("\"", text, "\" is not a whole number from ", low, " to ", high);
      },
      "");
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

std::string CheckOutput(const std::string& path) {
  const std::string extension = absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  const auto& known = OutputExtensions();
  if (std::find(known.begin(), known.end(), extension) != known.end()) return "";
  return absl::StrCat("\"", path, "\": extension \"", extension, "\" is not one of ", absl::StrJoin(known, " "));
}

template <class... Parts>
[[noreturn]] void Refuse(const Parts&... parts) {
  throw CLI::ValidationError(absl::StrCat(parts...), CLI::ExitCodes::ValidationError);
}

std::variant<NamedLattice, Basis> InterpretLattice(const VoxelizeWords& words) {
  if (!words.basis.empty()) {
    std::array<double, 9> n{};
    ParseNumbers(words.basis, n);
    return Basis{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}};
  }
  for (const auto& [name, lattice] : NamedLattices()) {
    if (name == words.lattice) return lattice;
  }
  return NamedLattice::kCartesian;
}

// 26, 18 and 6 count a voxel's neighbours, which is what they do on the Cartesian lattice only.
uint32_t InterpretSeparability(int given, const std::variant<NamedLattice, Basis>& lattice) {
  if (given <= 2) return static_cast<uint32_t>(given);
  if (lattice != std::variant<NamedLattice, Basis>(NamedLattice::kCartesian)) {
    Refuse("--separability: ", given, " is for --lattice cartesian; elsewhere 0, 1 or 2");
  }
  return given == 26 ? 0 : given == 18 ? 1 : 2;
}

std::filesystem::path Place(const std::string& path) {
  std::error_code error;
  const auto place = std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
  return error ? std::filesystem::path(path) : place;
}

void CheckOutputs(const VoxelizeOptions& options) {
  std::set<std::filesystem::path> places;
  for (const std::string& output : options.outputs) {
    if (!places.insert(Place(output)).second) Refuse("--out: \"", output, "\" is given twice");
    if (Place(output) == Place(options.mesh)) Refuse("--out: \"", output, "\" is the mesh itself");
  }
}

}  // namespace

void AddServerOptions(CLI::App& command, ServerChoice& choice) {
  command.add_option("--server", choice.address, "the server, as HOST:PORT or unix:PATH (default: a private latvoxd)")
      ->type_name("ADDRESS");
  command.add_option("--timeout", choice.timeout_seconds, "give up after S seconds")
      ->type_name("S")
      ->check(CheckPositive);
  command.add_option("--threads", choice.threads, "threads of a private latvoxd")
      ->type_name("N")
      ->check(Whole(1, kMaxThreads))
      ->excludes("--server");
}

void AddVoxelizeOptions(CLI::App& command, VoxelizeWords& words) {
  VoxelizeOptions& options = words.options;
  std::vector<std::string> lattices;
  for (const auto& [name, unused] : NamedLattices()) lattices.push_back(name);

  command.add_option("mesh", options.mesh, "mesh file: .drc .obj .ply .stl .glb .gltf")->type_name("MESH")->required();
  command.add_option("-o,--out", options.outputs, "output by extension: .vdb .csv .npy .ply .png; may be repeated")
      ->type_name("OUT")
      ->required()
      ->take_all()
      ->expected(1)
      ->check(CheckOutput);
  CLI::Option* lattice =
      command.add_option("--lattice", words.lattice, "default: cartesian")->check(CLI::IsMember(lattices));
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
  command.add_option("--algorithm", words.algorithm)->check(CLI::IsMember({"exact"}));
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
  command.add_flag("--json", options.json, "machine-readable summary on standard output");
  AddServerOptions(command, options.server);
}

VoxelizeOptions Interpret(const VoxelizeWords& words) {
  VoxelizeOptions options = words.options;
  VoxelizeRequest& request = options.request;
  request.lattice = InterpretLattice(words);
  request.separability = InterpretSeparability(words.separability, request.lattice);
  if (!words.voxel_size.empty()) ParseNumber(words.voxel_size, request.voxel_size.emplace());
  if (!words.resolution.empty()) ParseNumber(words.resolution, request.resolution.emplace());
  if (!words.origin.empty()) ParseNumbers(words.origin, request.origin.emplace());
  if (!words.region.empty()) {
    std::array<int32_t, 6> n{};
    ParseNumbers(words.region, n);
    request.region = IndexBox{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  }
  if (words.quantization != "auto") ParseNumber(words.quantization, options.quantization_bits.emplace());
  if (words.basis.empty() && !request.voxel_size && !request.resolution) {
    Refuse("--voxel-size or --resolution is required for a named lattice");
  }
  CheckOutputs(options);
  return options;
}

}  // namespace latvox::client
