#include "client/grid/request_metadata.h"

#include <variant>

#include "absl/strings/str_cat.h"
#include "client/json/labels_json.h"

namespace latvox::client {
namespace {

constexpr const char* kAlgorithms[] = {"exact", "brute-force", "incremental", "optimized-incremental"};

template <class Box>
std::string Corners(const Box& box) {
  Json numbers = box.min;
  for (const auto number : box.max) numbers.push_back(number);
  const std::string text = numbers.dump();
  return text.substr(1, text.size() - 2);
}

void AddSolid(const Solid& solid, Json& json) {
  json["rule"] = NameOf(solid.rule);
  if (solid.force_open) json["force_open"] = true;
  AddLabels(solid, json);
}

void AddBand(const Band& band, Json& json) {
  if (band.in_voxels) {
    json["band"] = absl::StrCat(Json(band.width).dump(), "v");
  } else {
    json["band"] = band.width;
  }
}

void AddEnclosed(const Enclosed& enclosed, Json& json) {
  if (enclosed.close > 0) json["close"] = enclosed.close;
  if (enclosed.leak_from) json["leak_from"] = *enclosed.leak_from;
  AddLabels(enclosed, json);
}

void AddConnected(const Connected& connected, Json& json) {
  json["seed"] = connected.seed;
  if (connected.close > 0) json["close"] = connected.close;
  if (connected.allow_outside) json["allow_outside"] = true;
}

// Whether a separating surface is found: for itself, or for another set.
bool Separates(const VoxelSet& set) {
  const auto* const solid = std::get_if<Solid>(&set);
  return solid != nullptr ? solid->surface == SolidSurface::kSeparating : !std::holds_alternative<Supercover>(set);
}

// Only a separating surface is thinned. Without a surface, fields of links may still ask for a separability.
void AddSurface(const VoxelizeRequest& request, Json& json) {
  const auto* const solid = std::get_if<Solid>(&request.set);
  const bool has_surface = solid == nullptr || solid->surface != SolidSurface::kNone;
  if (has_surface || request.separability != 0) json["separability"] = request.separability;
  if (Separates(request.set) && request.algorithm == Algorithm::kExact)
    json["minimal"] = request.minimal.value_or(true);
  json["algorithm"] = kAlgorithms[static_cast<size_t>(request.algorithm)];
}

void AddNote(const MeshNote& note, Json& json) {
  if (!note.up_axis.empty()) json["up_axis"] = note.up_axis;
  if (note.scale) json["scale"] = *note.scale;
  if (!note.input_format.empty()) json["input_format"] = note.input_format;
  if (note.quantization) json["quantization"] = *note.quantization;
  if (note.skip_bad) json["skip_bad"] = true;
  if (note.alpha_cutoff) json["alpha_cutoff"] = *note.alpha_cutoff;
  if (!note.priority.empty()) json["priority"] = note.priority;
  if (!note.fraction_labels.empty()) json["fraction_labels"] = note.fraction_labels;
}

// Everything except the note.
Json RequestJson(const VoxelizeRequest& request) {
  Json json;
  if (const auto* basis = std::get_if<Basis>(&request.lattice)) {
    for (const Vec3d& step : {basis->a, basis->b, basis->c}) {
      for (const double number : step) json["basis"].push_back(number);
    }
  } else {
    json["lattice"] = NameOf(std::get<NamedLattice>(request.lattice));
  }
  if (request.voxel_size) json["voxel_size"] = *request.voxel_size;
  if (request.resolution) json["resolution"] = *request.resolution;
  if (request.origin) json["origin"] = *request.origin;
  if (request.placement) json["placement"] = NameOf(*request.placement);
  json["set"] = NameOf(request.set);
  if (const auto* solid = std::get_if<Solid>(&request.set)) AddSolid(*solid, json);
  if (const auto* enclosed = std::get_if<Enclosed>(&request.set)) AddEnclosed(*enclosed, json);
  if (const auto* connected = std::get_if<Connected>(&request.set)) AddConnected(*connected, json);
  if (const auto* band = std::get_if<Band>(&request.set)) {
    AddBand(*band, json);
    if (request.separability != 0) json["separability"] = request.separability;
  } else if (const auto* links = std::get_if<Links>(&request.set)) {
    json["separability"] = request.separability;
    json["side"] = NameOf(links->side);
  } else {
    AddSurface(request, json);
  }
  for (const Field field : request.fields) {
    const bool has_number = FactsOf(field).is_of_cell();
    json["fields"].push_back(NameOf(field) + (has_number ? absl::StrCat(":", request.fraction_n) : ""));
  }
  if (!request.fraction_labels.empty()) json["fraction_labels"] = request.fraction_labels;
  if (request.signed_distance) json["signed"] = true;
  if (NeedsInteriorRule(request)) json["rule"] = NameOf(request.interior_rule);
  if (request.verify) json["verify"] = true;
  return json;
}

}  // namespace

std::string RequestText(const VoxelizeRequest& request, const MeshNote& note) {
  Json json = RequestJson(request);
  AddNote(note, json);
  return json.dump();
}

Metadata RequestMetadata(const VoxelizeRequest& request, const MeshNote& note) {
  Metadata metadata = {{"latvox_request", ToMetadata(RequestText(request, note))}};
  if (request.region) metadata["latvox_region"] = ToMetadata(Corners(*request.region));
  if (request.bounds) metadata["latvox_bounds"] = ToMetadata(Corners(*request.bounds));
  if (note.alpha_cutoff) metadata["latvox_alpha_cutoff"] = ToMetadata(double{*note.alpha_cutoff});
  if (const auto& facts = note.facts) {
    metadata["latvox_mesh_triangles"] = ToMetadata(static_cast<int64_t>(facts->triangles));
    metadata["latvox_mesh_box"] = ToMetadata(Corners(WorldBox{facts->min, facts->max}));
  }
  return metadata;
}

}  // namespace latvox::client
