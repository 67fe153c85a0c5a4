// The requests of the fault suite's clients, and the expected answers.
#ifndef LATVOX_TESTS_FAULTS_JOBS_H_
#define LATVOX_TESTS_FAULTS_JOBS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/types.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox::faults {

struct Job {
  std::string name;  // unique
  std::string drc;   // bytes of the mesh
  std::string lattice;
  uint32_t resolution = 0;
  uint32_t separability = 0;
  std::string digest;  // expected digest of the voxels, computed by latvox_bench without a server
  double weight = 1;   // how often it is requested, relative to the others
};

// Reads jobs from a JSON file: an array of objects with the members above, and `mesh`, the path of a .drc file, in
// place of `drc`. With `names`, returns only those. Errors: INVALID_ARGUMENT, NOT_FOUND.
absl::StatusOr<std::vector<Job>> ReadJobs(const std::string& path, const std::vector<std::string>& names);

client::VoxelizeRequest RequestOf(const Job& job);
v1::VoxelizeSpec SpecOf(const Job& job);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_JOBS_H_
