#include "tests/faults/jobs.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "client/mesh_files/input.h"

namespace latvox::faults {
namespace {

absl::StatusOr<Job> JobOf(const nlohmann::json& json) {
  Job job;
  job.name = json.at("name");
  job.lattice = json.at("lattice");
  job.resolution = json.at("resolution");
  job.separability = json.at("separability");
  job.digest = json.at("digest");
  job.weight = json.at("weight");
  auto drc = client::ReadBytes(json.at("mesh"));
  if (!drc.ok()) return drc.status();
  job.drc = *std::move(drc);
  return job;
}

}  // namespace

absl::StatusOr<std::vector<Job>> ReadJobs(const std::string& path, const std::vector<std::string>& names) {
  std::ifstream file(path);
  const nlohmann::json table = nlohmann::json::parse(file, nullptr, /*allow_exceptions=*/false);
  if (!table.is_array()) return absl::InvalidArgumentError(absl::StrCat(path, ": not an array of jobs"));
  std::vector<Job> jobs;
  for (const nlohmann::json& json : table) {
    const std::string name = json.at("name");
    if (!names.empty() && std::find(names.begin(), names.end(), name) == names.end()) continue;
    auto job = JobOf(json);
    if (!job.ok()) return job.status();
    jobs.push_back(*std::move(job));
  }
  if (jobs.empty() || (!names.empty() && jobs.size() != names.size())) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": has not all of the jobs asked for"));
  }
  return jobs;
}

client::VoxelizeRequest RequestOf(const Job& job) {
  client::VoxelizeRequest request;
  request.lattice = job.lattice == "bcc"   ? client::NamedLattice::kBcc
                    : job.lattice == "fcc" ? client::NamedLattice::kFcc
                                           : client::NamedLattice::kCartesian;
  request.resolution = job.resolution;
  request.separability = job.separability;
  return request;
}

v1::VoxelizeSpec SpecOf(const Job& job) {
  v1::VoxelizeSpec spec;
  spec.mutable_lattice()->set_named(job.lattice == "bcc"   ? v1::NAMED_LATTICE_BCC
                                    : job.lattice == "fcc" ? v1::NAMED_LATTICE_FCC
                                                           : v1::NAMED_LATTICE_CARTESIAN);
  spec.set_resolution(job.resolution);
  spec.set_separability(job.separability);
  spec.set_mesh_bytes(job.drc.size());
  return spec;
}

}  // namespace latvox::faults
