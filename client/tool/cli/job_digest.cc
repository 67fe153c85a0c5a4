#include "client/tool/cli/job_digest.h"

#include <string_view>
#include <variant>

#include "absl/strings/escaping.h"
#include "client/json/labels_json.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/input.h"
#include "latvox/mesh_id.h"

namespace latvox::client {
namespace {

template <class T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

absl::StatusOr<std::string> Sha256(std::string_view bytes) {
  const auto id = MeshIdOf(bytes);
  if (!id.ok()) return id.status();
  return absl::BytesToHexString(absl::string_view(reinterpret_cast<const char*>(id->sha256.data()), id->sha256.size()));
}

template <class T>
absl::StatusOr<std::string> Sha256Of(const std::vector<T>& values) {
  return Sha256({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
}

// Returns the attributes of the corners of all triangles.
std::vector<uint32_t> NumbersOf(const Mesh& mesh, const std::vector<Field>& attributes) {
  std::vector<uint32_t> numbers;
  AttributeNumbers of_mesh(mesh);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const uint32_t vertex : mesh.triangles[t]) {
      for (const Field attribute : attributes) numbers.push_back(of_mesh.At(t, vertex, attribute));
    }
  }
  return numbers;
}

// Returns the digest of images and of their places; "" if there are no base colors.
absl::StatusOr<std::string> BaseColorDigest(const BaseColors& colors) {
  if (colors.all.empty()) return "";
  std::string bytes;
  const auto append = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  for (const BaseColor& color : colors.all) {
    append(color.factor);
    append(color.wraps);
    append(color.is_smooth);
    if (color.image == nullptr) continue;
    const auto image = Sha256(color.image->bytes);
    if (!image.ok()) return image.status();
    bytes += *image;
  }
  for (const TriangleBaseColor& triangle : colors.triangles) append(triangle);
  for (const auto& corners : colors.vertices) append(corners);
  return Sha256(bytes);
}

absl::StatusOr<std::string> MeshDigest(const MeshSource& input) {
  if (!MayReferToFiles(input)) {
    std::string digests;
    for (const std::string& path : input.paths) {
      const auto bytes = ReadBytes(path);
      if (!bytes.ok()) return bytes.status();
      const auto digest = Sha256(*bytes);
      if (!digest.ok()) return digest.status();
      digests += *digest;
    }
    return digests;
  }
  const auto read = ReadMeshSource(input);
  if (!read.ok()) return read.status();
  const Mesh& mesh = std::get<Mesh>(*read);
  const auto positions = Sha256Of(mesh.positions), triangles = Sha256Of(mesh.triangles);
  if (!positions.ok()) return positions.status();
  if (!triangles.ok()) return triangles.status();
  if (input.attributes.empty() && !input.base_colors) return *positions + *triangles;
  const auto numbers = Sha256Of(NumbersOf(mesh, input.attributes)), colors = BaseColorDigest(mesh.base_colors);
  if (!numbers.ok()) return numbers.status();
  if (!colors.ok()) return colors.status();
  return *positions + *triangles + *numbers + *colors;
}

Json LatticeJson(const std::variant<NamedLattice, Basis>& lattice) {
  if (const auto* basis = std::get_if<Basis>(&lattice)) return {basis->a, basis->b, basis->c};
  return static_cast<int>(std::get<NamedLattice>(lattice));
}

Json RequestJson(const VoxelizeRequest& request) {
  const std::string set = NameOf(request.set);
  Json json = {{"lattice", LatticeJson(request.lattice)},
               {"voxel_size", OrNull(request.voxel_size)},
               {"resolution", OrNull(request.resolution)},
               {"origin", OrNull(request.origin)},
               {"separability", request.separability},
               {"minimal", request.minimal.value_or(set != "supercover" && set != "supercover-solid" &&
                                                    set != "interior" && set != "band")},
               {"verify", request.verify},
               {"algorithm", static_cast<int>(request.algorithm)},
               {"set", set}};
  if (request.placement) json["placement"] = NameOf(*request.placement);
  if (request.region) json["region"] = {request.region->min, request.region->max};
  if (request.bounds) json["bounds"] = {request.bounds->min, request.bounds->max};
  if (const auto* band = std::get_if<Band>(&request.set)) json["band"] = {band->width, band->in_voxels};
  if (const auto* links = std::get_if<Links>(&request.set)) json["side"] = NameOf(links->side);
  for (const Field field : request.fields) json["fields"].push_back(NameOf(field));
  if (request.signed_distance) json["signed"] = true;
  if (NeedsInteriorRule(request)) json["rule"] = NameOf(request.interior_rule);
  if (request.fraction_n != 0) json["fraction_n"] = request.fraction_n;
  if (!request.fraction_labels.empty()) json["fraction_labels"] = request.fraction_labels;
  if (request.shard) json["shard"] = {request.shard->index, request.shard->count};
  if (const auto* enclosed = std::get_if<Enclosed>(&request.set)) {
    json["walk"] = {enclosed->close, OrNull(enclosed->leak_from)};
    AddLabels(*enclosed, json);
  }
  if (const auto* connected = std::get_if<Connected>(&request.set)) {
    json["walk"] = {connected->close, connected->seed, connected->allow_outside};
  }
  if (const auto* solid = std::get_if<Solid>(&request.set)) {
    json["solid"] = {static_cast<int>(solid->rule), solid->force_open};
    AddLabels(*solid, json);
  }
  return json;
}

}  // namespace

absl::StatusOr<std::string> JobDigest(const Job& job) {
  const auto mesh = MeshDigest(job.options.mesh);
  if (!mesh.ok()) return mesh.status();
  Json json = {{"request", RequestJson(job.options.request)},
               {"quantization_bits", OrNull(job.options.quantization_bits)},
               {"outputs", job.names},
               {"mesh", *mesh}};
  const MeshSource& input = job.options.mesh;
  if (input.up != UpAxis::kZ) json["up"] = static_cast<int>(input.up);
  if (input.scale != 1) json["scale"] = input.scale;
  if (input.skip_bad) json["skip_bad"] = true;
  if (input.format) json["input_format"] = static_cast<int>(*input.format);
  if (job.options.output_options.picture_up != UpAxis::kY) json["picture_up"] = "z";
  if (job.options.output_options.dense_npy) json["npy"] = "dense";
  if (const auto& array = job.options.output_options.array) json["array"] = JoinNames(*array);
  const BoxShape& shape = job.options.output_options.shape;
  if (shape.dims) json["dims"] = *shape.dims;
  if (shape.pad > 0) json["pad"] = shape.pad;
  if (job.options.upload != UploadForm::kAuto) json["upload"] = static_cast<int>(job.options.upload);
  if (job.options.alpha_cutoff) json["alpha_cutoff"] = *job.options.alpha_cutoff;
  if (!job.options.priority.empty()) json["priority"] = job.options.priority;
  if (!job.options.fraction_labels.empty()) json["fraction_labels"] = job.options.fraction_labels;
  if (job.options.strict) json["strict"] = true;
  if (job.options.weld_report) json["weld_report"] = true;
  // Names may not be UTF-8.
  return Sha256(json.dump(-1, ' ', false, Json::error_handler_t::ignore));
}

}  // namespace latvox::client
